#include "app/windows/middle_view.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "app/windows/panels.h"

namespace planlight {
namespace {

float button_height(const Pen& pen) {
    return std::max(72.0F, 76 * pen.scale);
}

/// Right half of the view's upper edge, so that the letters at the middle of its edges stay free.
Box fit_row(const Pen& pen, const Box& place) {
    const float from = place.x + 0.5F * place.width + 44 * pen.scale;
    return {from, place.y + 12 * pen.scale, place.right() - 12 * pen.scale - from, button_height(pen)};
}

/// Lower left corner of the view.
Box corner_of(const Pen& pen, const Box& place) {
    const float height = button_height(pen);
    return {place.x + 12 * pen.scale, place.bottom() - 12 * pen.scale - height, 0.7F * fit_row(pen, place).width,
            height};
}

}  // namespace

MiddleView::MiddleView(const FontFiles& fonts, std::function<void()> make_current)
    : fonts_(fonts), make_current_(std::move(make_current)), scene_(fonts_, make_current_) {}

OperatorAction MiddleView::draw(const Pen& pen, const Box& place, const OperatorModel& model) {
    places_.clear();
    if (!model.fit) fit_view = FitView::after;
    if (landmarks_ && model.landmarks) landmarks_->follow(*model.landmarks);
    landmarks_open_ = landmarks_open_ && model.landmarks;
    if (landmarks_open_) return draw_landmarks(pen, place, model);
    draw_scene(pen, place, model);
    if (model.fit) draw_fit_buttons(pen, fit_row(pen, place));
    return draw_corner_buttons(pen, corner_of(pen, place), model);
}

LandmarkPanel& MiddleView::open_landmarks() {
    landmarks_open_ = true;
    if (!landmarks_) {
        landmarks_ = std::make_unique<LandmarkPanel>(fonts_, make_current_);
        landmarks_->set_skin_view({scene_.view().azimuth, scene_.view().elevation, 1, Eigen::Vector2d::Zero()});
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
    const float strip = button_height(pen) + 24 * pen.scale;  // of buttons, which a finger must meet at once
    const float above = model.fit ? strip : 0;
    const float below =
        (model.landmarks ? strip : 0) + (model.fit && model.confirm ? strip : 0) + (model.check_skin ? strip : 0);
    scene_.take_mouse("scene", {place.x, place.y + above, place.width, place.height - above - below});
    scene_.draw(pen, place, shown);
    draw_title(pen, place, model, shown);
}

void MiddleView::draw_title(const Pen& pen, const Box& place, const OperatorModel& model,
                            const SceneModel& shown) const {
    std::string title = "Skin from CT";
    if (shown.skin_error_mm) title += " coloured by how far off the match may be";
    if (shown.cloud) title += shown.cloud_distance_mm ? " · scan coloured by distance" : " · scan";
    if (model.fit && fit_view == FitView::before) title += " before the fine match";
    if (shown.plan) title += " · plan";
    if (shown.light) title += " · light as it falls (white)";
    const float indent = 18 * pen.scale;
    pen.paragraph(
        pen.fonts.small, title,
        {place.x + indent, place.y + 14 * pen.scale, 0.44F * place.width - indent, 2.2F * line_height(pen.fonts.small)},
        theme::kText);
}

void MiddleView::draw_fit_buttons(const Pen& pen, const Box& row) {
    const std::array<std::tuple<FitView, const char*, const char*>, 3> views{
        {{FitView::before, "Before", "before"},
         {FitView::after, "After", "after"},
         {FitView::predicted_error, "Error", "error"}}};
    const float gap = 8 * pen.scale;
    Box box{row.x, row.y, (row.width - 2 * gap) / 3, row.height};
    for (const auto& [view, label, word] : views) {
        places_[word] = box;
        if (button(pen, box, label, {true, {}}, fit_view == view)) fit_view = view;
        box.x += box.width + gap;
    }
}

OperatorAction MiddleView::draw_corner_buttons(const Pen& pen, Box corner, const OperatorModel& model) {
    if (model.landmarks) {
        places_["landmarks"] = corner;
        if (button(pen, corner, "Landmarks", {true, {}})) open_landmarks();
        corner.y -= corner.height + 12 * pen.scale;
    }
    OperatorAction wanted = OperatorAction::none;
    if (model.check_skin) {
        places_["check-skin"] = corner;
        if (button(pen, corner, "Check skin", {true, {}})) wanted = OperatorAction::check_skin;
        corner.y -= corner.height + 12 * pen.scale;
    }
    if (!model.fit || !model.confirm) return wanted;
    places_["confirm"] = corner;
    return button(pen, corner, model.confirm_words, {true, {}}) ? OperatorAction::confirm : wanted;
}

Box MiddleView::place_of(const std::string& button) const {
    const auto found = places_.find(button);
    return found == places_.end() ? Box{} : found->second;
}

}  // namespace planlight
