#include "app/windows/evidence_page.h"

#include <algorithm>
#include <cmath>

#include "app/windows/number_text.h"
#include "app/windows/operator_keys.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

std::string words_of(const Pen& pen, const PlanRow& row) {
    std::string words = pen.say(row.name + ". " +
                                (row.predicted_error_mm ? "By the match it lies within " +
                                                              number_text(row.predicted_error_mm, "mm") + " (95 %)."
                                                        : "How far off it may be is not known yet."));
    if (row.light_off_mm)
        words += " " + pen.say("Its light was seen " + number_text(row.light_off_mm, "mm") + " beside its place.");
    return words;
}

ImU32 colour_for(const PlanRow& row, const OperatorModel& model) {
    const double worst = std::max(std::abs(row.predicted_error_mm.value_or(0)), std::abs(row.light_off_mm.value_or(0)));
    return worst > model.stop_above_mm ? theme::kRed : worst > model.warn_above_mm ? theme::kAmber : theme::kText;
}

}  // namespace

float EvidencePage::draw_items(const Pen& pen, Box box, const Box& seen, const OperatorModel& model, Pressed& pressed) {
    const float from = box.y, swatch = 30 * pen.scale, size = 8 * pen.scale, gap = 8 * pen.scale;
    const float button_height = std::max(72.0F, 76 * pen.scale), button_width = 250 * pen.scale;
    box.y += pen.paragraph(pen.fonts.title, pen.say("The plan"), box, theme::kText) + gap;
    for (std::size_t i = 0; i < model.rows.size(); ++i) {
        const PlanRow& row = model.rows[i];
        const bool alone = model.item_of_moment == i;
        const Box at{box.right() - button_width, box.y, button_width, button_height};
        // Half of a button at the page's edge is drawn, and not pressed.
        const bool whole = at.y >= seen.y && at.bottom() <= seen.bottom();
        if (whole) places_["item-" + std::to_string(i + 1)] = at;
        if (at.bottom() > seen.y && at.y < seen.bottom()) {
            ImGui::PushID(static_cast<int>(i));
            const ButtonState state{model.may_light_item, model.may_light_item ? "" : "no match"};
            const bool hit = button(pen, at, alone ? "Whole plan" : "Only this", state, {alone, false, {}});
            if (hit && whole) pressed.item = i;
            ImGui::PopID();
        }
        const float middle = box.y + line_height(pen.fonts.body) / 2;
        pen.list->AddRectFilled({box.x, middle - size}, {box.x + 2 * size, middle + size}, colour_of(row.colour),
                                3 * pen.scale);
        const Box words{box.x + swatch, box.y, box.width - swatch - button_width - 2 * gap, 1e5F};
        const float used = pen.paragraph(pen.fonts.body, words_of(pen, row), words, colour_for(row, model));
        box.y += std::max(used, button_height) + gap;
    }
    return box.y - from;
}

float EvidencePage::draw_sentences(const Pen& pen, Box box, const OperatorModel& model) const {
    const float from = box.y;
    box.height = 1e5F;
    box.y += pen.paragraph(pen.fonts.title, pen.say("What it is judged by"), box, theme::kText);
    if (model.evidence.empty())
        box.y += pen.paragraph(pen.fonts.body, pen.say("Nothing yet: there is no match."), box, theme::kQuiet);
    for (const std::string& sentence : model.evidence)
        box.y += pen.paragraph(pen.fonts.body, pen.say(sentence), box, theme::kText) + 8 * pen.scale;
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

EvidencePage::Pressed EvidencePage::draw(const Pen& pen, const Box& place, const OperatorModel& model) {
    Pressed pressed;
    places_.clear();
    pen.panel(place);
    const float pad = 22 * pen.scale, height = std::max(72.0F, 76 * pen.scale);
    const Box close{place.right() - pad - 260 * pen.scale, place.bottom() - pad / 2 - height, 260 * pen.scale, height};
    places_["close"] = close;
    const Box words{place.x + pad, place.y + pad, place.width - 2 * pad, close.y - place.y - 1.5F * pad};

    pen.list->PushClipRect({words.x, words.y}, {words.right(), words.bottom()}, true);
    Box at{words.x, words.y - scrolled_, words.width, 1e5F};
    const float items = draw_items(pen, at, words, model, pressed) + 14 * pen.scale;
    at.y += items;
    height_ = items + draw_sentences(pen, at, model);
    pen.list->PopClipRect();
    take_drag(words);  // after the items' buttons, which a finger must meet first
    if (height_ > words.height)
        pen.line(pen.fonts.small, pen.say("Drag, or turn the mouse wheel, for the rest."), place.x + pad,
                 close.y + close.height / 2, close.x - place.x - 2 * pad, theme::kAmber);
    pressed.close = button(pen, close, "Close", {true, {}}, {false, false, key_text(KeyMeaning::evidence)});
    return pressed;
}

}  // namespace planlight
