#include "app/windows/evidence_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/windows/number_text.h"
#include "app/windows/operator_keys.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

/// "B1, ⌀7, 6 mm deep": a name that ends in a number does not run into the figure behind it.
std::string with_commas(std::string name) {
    constexpr std::string_view kApart = "  ";
    for (std::size_t at = name.find(kApart); at != std::string::npos; at = name.find(kApart, at))
        name.replace(at, kApart.size(), ", ");
    return name;
}

std::string words_of(const Pen& pen, const PlanRow& row, const OperatorModel& model) {
    const std::initializer_list<double> limits{model.warn_above_mm, model.stop_above_mm};
    if (row.hidden) return with_commas(row.name) + ". " + pen.say("Hidden: it is not lit.");
    std::string words =
        pen.say(with_commas(row.name) + ". " +
                (row.predicted_error_mm
                     ? "By the match it lies within " + error_text(row.predicted_error_mm, "mm", limits) + " (95 %)."
                     : "How far off it may be is not known yet."));
    if (row.bare) words += " " + pen.say("No name stands beside its light.");
    if (row.light_off_mm)
        words +=
            " " + pen.say("Its light was seen " + error_text(row.light_off_mm, "mm", limits) + " beside its place.");
    for (const Clearance& risk : row.risk)
        words += " " + pen.say(risk.through
                                   ? "It is planned through " + risk.structure + "."
                                   : fmt::format("It is planned {:.1f} mm from {}.", said_mm(risk), risk.structure));
    return words;
}

ImU32 colour_for(const Pen& pen, const PlanRow& row, const OperatorModel& model) {
    const double worst = std::max(std::abs(row.predicted_error_mm.value_or(0)), std::abs(row.light_off_mm.value_or(0)));
    return worst > model.stop_above_mm || through_risk(row) ? pen.theme->red
           : worst > model.warn_above_mm || near_risk(row)  ? pen.theme->amber
                                                            : pen.theme->text;
}

}  // namespace

/// Half of a button at the page's edge is drawn, and not pressed.
bool EvidencePage::item_button(const Pen& pen, const Box& at, const Box& seen, const std::string& label,
                               const ButtonState& state, const ButtonLook& look, const std::string& place) {
    const bool whole = at.y >= seen.y && at.bottom() <= seen.bottom();
    if (whole) places_[place] = at;
    if (at.bottom() <= seen.y || at.y >= seen.bottom()) return false;
    ImGui::PushID(place.c_str());
    const bool hit = button(pen, at, label, state, look);
    ImGui::PopID();
    return hit && whole;
}

float EvidencePage::draw_items(const Pen& pen, Box box, const Box& seen, const OperatorModel& model, Pressed& pressed) {
    const float from = box.y, swatch = 30 * pen.scale, size = 8 * pen.scale, gap = 8 * pen.scale;
    const float button_high = button_height(pen.scale), button_width = 220 * pen.scale;
    const ButtonState state{model.may_light_item, model.may_light_item ? "" : "no match"};
    box.y += pen.paragraph(pen.fonts.title, pen.say("The plan"), box, pen.theme->text) + gap;
    for (std::size_t i = 0; i < model.rows.size(); ++i) {
        const PlanRow& row = model.rows[i];
        const bool alone = model.item_of_moment == i, marked = marked_ == i;
        const std::string number = std::to_string(i + 1);
        const Box only{box.right() - button_width, box.y, button_width, button_high};
        const Box hide{only.x - gap - button_width, box.y, button_width, button_high};
        if (item_button(pen, only, seen, alone ? "Whole plan" : "Only this", state, {alone, false, {}},
                        "item-" + number))
            pressed.item = i;
        if (item_button(pen, hide, seen, row.hidden ? "Show" : "Hide", state,
                        {row.hidden, false, marked ? key_text(KeyMeaning::hide_item) : ""}, "hide-" + number))
            pressed.hidden = i;
        const float middle = box.y + line_height(pen.fonts.body) / 2;
        const Box words{box.x + swatch, box.y, hide.x - box.x - swatch - gap, 1e5F};
        if (row.hidden)
            pen.list->AddRect({box.x, middle - size}, {box.x + 2 * size, middle + size}, colour_of(row.colour),
                              3 * pen.scale, 0, 2 * pen.scale);
        else
            pen.swatch({box.x, middle - size, 2 * size, 2 * size}, row.colour);
        const float used = pen.paragraph(pen.fonts.body, words_of(pen, row, model), words,
                                         row.hidden ? pen.theme->quiet : colour_for(pen, row, model));
        const float height = std::max(used, button_high);
        if (marked) {
            marked_at_ = {box.x, box.y, box.width, height};
            pen.list->AddRect({box.x - gap, box.y - gap / 2}, {hide.x - gap / 2, box.y + height + gap / 2},
                              pen.theme->blue, 6 * pen.scale, 0, 3 * pen.scale);
        }
        box.y += height + gap;
    }
    return box.y - from;
}

float EvidencePage::draw_sentences(const Pen& pen, Box box, const OperatorModel& model) const {
    const float from = box.y;
    box.height = 1e5F;
    box.y += pen.paragraph(pen.fonts.title, pen.say("What it is judged by"), box, pen.theme->text);
    if (model.evidence.empty())
        box.y += pen.paragraph(pen.fonts.body, pen.say("Nothing yet: there is no match."), box, pen.theme->quiet);
    for (const std::string& sentence : model.evidence)
        box.y += pen.paragraph(pen.fonts.body, pen.say(sentence), box, pen.theme->text) + 8 * pen.scale;
    return box.y - from;
}

void EvidencePage::take_drag(const Box& words) {
    ImGui::SetCursorScreenPos({words.x, words.y});
    ImGui::InvisibleButton("evidence page", {words.width, words.height});
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsItemActive()) scrolled_ -= io.MouseDelta.y;
    if (ImGui::IsItemHovered()) scrolled_ -= 60 * words.width / 1200 * io.MouseWheel;
    scrolled_ = std::clamp(scrolled_, 0.0F, std::max(0.0F, height_ - words.height));
}

/// A row that has just been marked is seen whole.
void EvidencePage::bring_into_sight(const Box& words) {
    if (!std::exchange(new_mark_, false)) return;
    const float above = words.y - marked_at_.y, below = marked_at_.bottom() - words.bottom();
    if (above > 0) scrolled_ -= above;
    if (below > 0) scrolled_ += below;
}

EvidencePage::Pressed EvidencePage::draw(const Pen& pen, const Box& place, const OperatorModel& model,
                                         std::optional<std::size_t> marked) {
    Pressed pressed;
    new_mark_ = marked && marked != marked_;
    marked_ = marked;
    places_.clear();
    pen.panel(place);
    const float pad = 22 * pen.scale, height = button_height(pen.scale);
    const Box close{place.right() - pad - 260 * pen.scale, place.bottom() - pad / 2 - height, 260 * pen.scale, height};
    places_["close"] = close;
    const Box words{place.x + pad, place.y + pad, place.width - 2 * pad, close.y - place.y - 1.5F * pad};

    pen.list->PushClipRect({words.x, words.y}, {words.right(), words.bottom()}, true);
    Box at{words.x, words.y - scrolled_, words.width, 1e5F};
    const float items = draw_items(pen, at, words, model, pressed) + 14 * pen.scale;
    at.y += items;
    height_ = items + draw_sentences(pen, at, model);
    pen.list->PopClipRect();
    bring_into_sight(words);
    take_drag(words);  // after the items' buttons, which a finger must meet first
    if (height_ > words.height)
        pen.line(pen.fonts.small, pen.say("Drag, or turn the mouse wheel, for the rest."), place.x + pad,
                 close.y + close.height / 2, close.x - place.x - 2 * pad, pen.theme->amber);
    pressed.close = button(pen, close, "Close", {true, {}}, {false, false, key_text(KeyMeaning::evidence)});
    return pressed;
}

}  // namespace planlight
