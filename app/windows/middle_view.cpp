#include "app/windows/middle_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "app/windows/orientation.h"
#include "app/windows/panels.h"

namespace planlight {
namespace {

/// Not all of the plan is bright.
bool part_of_plan(const OperatorModel& model) {
    return model.item_of_moment ||
           std::any_of(model.rows.begin(), model.rows.end(), [](const PlanRow& row) { return row.hidden; });
}

std::optional<LandmarkButton> landmark_button(KeyMeaning key) {
    if (key == KeyMeaning::landmark_undo) return LandmarkButton::undo;
    if (key == KeyMeaning::landmark_turn) return LandmarkButton::turn;
    if (key == KeyMeaning::landmark_use) return LandmarkButton::use;
    return std::nullopt;
}

}  // namespace

MiddleView::MiddleView(const FontFiles& fonts, std::function<void()> make_current)
    : fonts_(fonts), make_current_(std::move(make_current)), scene_(fonts_, make_current_) {}

OperatorAction MiddleView::draw(const Pen& pen, const Box& place, const OperatorModel& model) {
    places_.clear();
    if (!model.fit) fit_view = FitView::after;
    if (landmarks_ && model.landmarks) landmarks_->follow(*model.landmarks);
    landmarks_open_ = landmarks_open_ && model.landmarks;
    if (evidence_open_) {
        const EvidencePage::Pressed pressed = evidence_.draw(pen, place, model, marked_);
        evidence_open_ = !pressed.close;
        places_ = evidence_.places();
        if (pressed.hidden) return hide_or_show(*pressed.hidden, model);
        if (!pressed.item) return OperatorAction::none;
        const bool whole_plan = model.item_of_moment == pressed.item;  // so it says on the button then
        item_wanted_ = whole_plan ? std::nullopt : pressed.item;
        return whole_plan ? OperatorAction::show_item : OperatorAction::light_item;
    }
    if (landmarks_open_) return draw_landmarks(pen, place, model);
    draw_scene(pen, place, model);
    draw_fit_buttons(pen, fit_row(place, pen.scale), model);
    return draw_corner_buttons(pen, corner_button(place, pen.scale), model);
}

OperatorAction MiddleView::press(KeyMeaning key, const OperatorModel& model) {
    why_not_.clear();
    const auto look_at = [&](FitView view) {
        if (model.fit)
            fit_view = view;
        else
            why_not_ = "There is no match to look at yet.";
    };
    if (key == KeyMeaning::before) look_at(FitView::before);
    if (key == KeyMeaning::after) look_at(FitView::after);
    if (key == KeyMeaning::error) look_at(FitView::predicted_error);
    if (key == KeyMeaning::evidence) evidence_open_ = !evidence_open_;
    if (key == KeyMeaning::landmarks) {
        if (landmarks_open_)
            landmarks_open_ = false;
        else if (model.landmarks)
            open_landmarks();
        else
            why_not_ = "Landmarks are clicked on a scan, and there is none.";
    }
    if (const auto pressed = landmark_button(key)) return press_landmarks(*pressed);
    if (const std::string why = views_.press(key, model, scene_); !why.empty()) why_not_ = why;
    mark_row(key, model);
    if (key == KeyMeaning::next_item || key == KeyMeaning::all_items || key == KeyMeaning::hide_item)
        return press_item(key, model);
    // Only what is seen is pressed: not under another page.
    if (key == KeyMeaning::confirm && model.confirm && places_.contains("confirm")) return OperatorAction::confirm;
    if (key == KeyMeaning::confirm) why_not_ = "There is nothing to say yes to now.";
    if (key == KeyMeaning::check_skin && model.check_skin) return OperatorAction::check_skin;
    if (key == KeyMeaning::check_skin) why_not_ = "The skin is checked while the light follows the patient.";
    return OperatorAction::none;
}

OperatorAction MiddleView::press_landmarks(LandmarkButton which) {
    if (!landmarks_open_ || evidence_open_) {
        why_not_ = "That key is for landmarks, and they are not open.";
        return OperatorAction::none;
    }
    why_not_ = landmarks_->why_not(which);
    if (!why_not_.empty()) return OperatorAction::none;
    landmarks_->press(which);
    if (which != LandmarkButton::use) return OperatorAction::none;
    landmarks_open_ = false;
    return OperatorAction::use_landmarks;
}

OperatorAction MiddleView::hide_or_show(std::size_t row, const OperatorModel& model) {
    item_wanted_ = row;
    return model.rows[row].hidden ? OperatorAction::show_item : OperatorAction::hide_item;
}

/// The row above or below; at first the first or the last one.
void MiddleView::mark_row(KeyMeaning key, const OperatorModel& model) {
    const std::size_t count = model.rows.size();
    if (count == 0 || (marked_ && *marked_ >= count)) marked_.reset();
    if ((key != KeyMeaning::row_above && key != KeyMeaning::row_below) || count == 0) return;
    if (!marked_)
        marked_ = key == KeyMeaning::row_below ? 0 : count - 1;
    else if (key == KeyMeaning::row_below)
        marked_ = std::min(*marked_ + 1, count - 1);
    else
        marked_ = *marked_ > 0 ? *marked_ - 1 : 0;
}

/// One item after the other that is not hidden, then all of the plan again; or the marked one hidden or shown.
OperatorAction MiddleView::press_item(KeyMeaning key, const OperatorModel& model) {
    if (!model.may_light_item) {
        why_not_ = "Items are lit alone, or hidden, once the patient is found.";
        return OperatorAction::none;
    }
    if (key == KeyMeaning::hide_item) {
        if (marked_) return hide_or_show(*marked_, model);
        why_not_ = "Mark a row of the plan with the arrow keys first; H hides it, or shows it again.";
        return OperatorAction::none;
    }
    item_wanted_.reset();
    if (key == KeyMeaning::all_items) return OperatorAction::show_item;
    std::size_t next = model.item_of_moment ? *model.item_of_moment + 1 : 0;
    while (next < model.rows.size() && model.rows[next].hidden) ++next;
    if (next < model.rows.size()) item_wanted_ = marked_ = next;
    return OperatorAction::light_item;
}

LandmarkPanel& MiddleView::open_landmarks() {
    evidence_open_ = false;
    landmarks_open_ = true;
    if (!landmarks_) {
        landmarks_ = std::make_unique<LandmarkPanel>(fonts_, make_current_);
        landmarks_->set_skin_view({scene_.view().azimuth, scene_.view().elevation, 0, 1, Eigen::Vector2d::Zero()});
    }
    return *landmarks_;
}

OperatorAction MiddleView::draw_landmarks(const Pen& pen, const Box& place, const OperatorModel& model) {
    const auto pressed = landmarks_->draw(pen, place, *model.landmarks, model.use_landmarks);
    places_ = landmarks_->places();
    if (pressed == LandmarkButton::close || pressed == LandmarkButton::use) landmarks_open_ = false;
    return pressed == LandmarkButton::use ? OperatorAction::use_landmarks : OperatorAction::none;
}

void MiddleView::draw_scene(const Pen& pen, const Box& place, const OperatorModel& model) {
    pen.panel(place);
    const SceneModel shown = scene_of_fit(model, fit_view);
    const float strip = button_height(pen.scale) + 24 * pen.scale;  // of buttons, which a finger must meet at once
    const float above = strip + (views_.open() ? ViewButtons::height(pen.scale) : 0);
    const int rows = (model.landmarks ? 1 : 0) + (model.confirm ? 1 : 0) + (model.check_skin ? 1 : 0) +
                     (part_of_plan(model) ? 1 : 0);
    const float below = strip * static_cast<float>(rows);
    const Box sensitive{place.x, place.y + above, place.width, std::max(1.0F, place.height - above - below)};
    scene_.take_mouse("scene", sensitive);
    if (!shown.skin && !shown.cloud) return;  // nothing to be seen yet
    views_.follow(model, scene_);
    const Box corner = corner_button(place, pen.scale);
    look_at_what_is_lit(pen, place,
                        {corner.right(), place.y + above, place.right() - corner.right(), place.height - above}, model);
    // Where buttons reach the middle of an edge, its letter stands beside them.
    const float middle = place.y + place.height / 2, reach = 24 * pen.scale;
    LetterInsets insets;
    if (place.bottom() - below < middle + reach) insets.left = static_cast<double>(corner.right() - place.x);
    if (views_.open() && place.y + above > middle - reach)
        insets.right = static_cast<double>(place.right() - fit_row(place, pen.scale).x);
    scene_.draw(pen, place, shown, insets);
    draw_title(pen, place, model, shown);
}

void MiddleView::draw_title(const Pen& pen, const Box& place, const OperatorModel& model,
                            const SceneModel& shown) const {
    std::string title = pen.say(model.look_at ? "Skin from CT: the ring is where the light belongs."
                                : shown.plan  ? "Skin from CT, with the plan."
                                              : "Skin from CT.");
    const auto add = [&](const std::string& sentence) { title += " " + pen.say(sentence); };
    if (model.fit && fit_view == FitView::before)
        add("BEFORE: the scan where the first, rough match put it, coloured by its distance.");
    else if (shown.cloud && shown.cloud_distance_mm)
        add("AFTER: the scan where the fine match put it; green lies on the skin.");
    else if (shown.cloud)
        add("The scan.");
    if (shown.cloud_distance_mm && std::abs(shown.skin_offset_mm) >= 0.05)
        add(fmt::format("The skin lies {:.1f} mm {} that of the CT; distances are counted from there.",
                        std::abs(shown.skin_offset_mm), shown.skin_offset_mm < 0 ? "inside of" : "outside of"));
    if (shown.skin_error_mm) add("ERROR: how far off the light may be at each place.");
    if (shown.light) add("White: the light as it falls.");
    const float indent = 18 * pen.scale;
    pen.paragraph(
        pen.fonts.small, title,
        {place.x + indent, place.y + 14 * pen.scale, 0.44F * place.width - indent, 6.2F * line_height(pen.fonts.small)},
        on_pictures().text);
}

/// When a place begins to be lit for a person to look at, the picture shows its side of the head, with the place beside
/// the buttons; afterwards it is as it was before.
void MiddleView::look_at_what_is_lit(const Pen& pen, const Box& place, const Box& free, const OperatorModel& model) {
    if (model.look_at == looked_at_) return;
    looked_at_ = model.look_at;
    if (!looked_at_) {
        if (view_before_) scene_.look(*view_before_);
        view_before_.reset();
        return;
    }
    if (!view_before_) view_before_ = scene_.view();
    SceneView view = view_along(looked_at_->from_in_ct, {0, 0, 1});
    view = {view.azimuth, view.elevation, 0, scene_.view().zoom, Eigen::Vector2d::Zero()};
    scene_.look(view);
    scene_.draw(pen, place, scene_of_fit(model, fit_view));
    const ImVec2 at = scene_.pixel_of(looked_at_->p_in_ct);
    const float wanted_x = std::clamp(at.x, free.x + 0.2F * free.width, free.x + 0.8F * free.width),
                wanted_y = std::clamp(at.y, free.y + 0.2F * free.height, free.y + 0.8F * free.height);
    view.shift_mm = scene_.mm_per_pixel() *
                    Eigen::Vector2d(static_cast<double>(wanted_x - at.x), static_cast<double>(at.y - wanted_y));
    scene_.look(view);
}

void MiddleView::draw_fit_buttons(const Pen& pen, const Box& row, const OperatorModel& model) {
    const std::array<std::tuple<FitView, const char*, const char*, KeyMeaning>, 3> views{
        {{FitView::before, "Before", "before", KeyMeaning::before},
         {FitView::after, "After", "after", KeyMeaning::after},
         {FitView::predicted_error, "Error", "error", KeyMeaning::error}}};
    const float gap = 8 * pen.scale;
    Box box{row.x, row.y, (row.width - 3 * gap) / 4, row.height};
    const Box last{row.right() - box.width, row.y, box.width, row.height};
    views_.draw_opener(pen, last);
    views_.draw(pen, {row.x, row.bottom() + gap, row.width, row.height}, model, scene_);
    for (const auto& [word, at] : views_.places()) places_[word] = at;
    if (!model.fit) return;
    for (const auto& [view, label, word, key] : views) {
        places_[word] = box;
        if (button(pen, box, label, {true, {}}, {fit_view == view, false, key_text(key)})) fit_view = view;
        box.x += box.width + gap;
    }
}

OperatorAction MiddleView::draw_corner_buttons(const Pen& pen, Box corner, const OperatorModel& model) {
    if (model.landmarks) {
        places_["landmarks"] = corner;
        if (button(pen, corner, "Landmarks", {true, {}}, {false, false, key_text(KeyMeaning::landmarks)}))
            open_landmarks();
        corner.y -= corner.height + 12 * pen.scale;
    }
    OperatorAction wanted = OperatorAction::none;
    if (model.check_skin) {
        places_["check-skin"] = corner;
        if (button(pen, corner, "Check skin", {true, {}}, {false, false, key_text(KeyMeaning::check_skin)}))
            wanted = OperatorAction::check_skin;
        corner.y -= corner.height + 12 * pen.scale;
    }
    if (part_of_plan(model)) {  // above all others, which keep their places: the second of two clicks falls on none
        Box above = corner;
        above.y -= above.height + 12 * pen.scale;
        places_["all-items"] = above;
        if (button(pen, above, "Show the whole plan", {true, {}}, {false, false, key_text(KeyMeaning::all_items)}))
            wanted = press_item(KeyMeaning::all_items, model);
    }
    if (!model.confirm) return wanted;
    places_["confirm"] = corner;
    const bool leads_on = model.next == OperatorAction::confirm;
    const ButtonLook look{false, leads_on, keys_of_button(KeyMeaning::confirm, leads_on)};
    return button(pen, corner, model.confirm_words, {true, {}}, look) ? OperatorAction::confirm : wanted;
}

Box MiddleView::place_of(const std::string& button) const {
    const auto found = places_.find(button);
    return found == places_.end() ? Box{} : found->second;
}

}  // namespace planlight
