#pragma once

#include <array>
#include <optional>

#include "app/windows/pen.h"
#include "app/windows/review_model.h"

namespace planlight {

/// Where everything stands in the window of a review.
struct ReviewLayout {
    float scale = 1;
    Box title, left, right, head, words, time_line;
    std::array<Box, 8> buttons;  ///< in a row, or in two where the window stands on end
};
ReviewLayout review_layout(float width, float height);

/// A camera's picture with the plan over it. `whole`: all of it; else the part that the plan is in. Returns the pixel
/// of the picture under `press` (window pixels); empty where that is none.
std::optional<Eigen::Vector2d> draw_review_camera(const Pen& pen, const Box& box, const ReviewModel& model,
                                                  std::size_t camera, bool whole, ImTextureID texture,
                                                  const std::optional<ImVec2>& press);

/// What the projector was given.
void draw_review_light(const Pen& pen, const Box& box, const ReviewModel& model, ImTextureID texture);

/// What the gate said, what happened, and how far off the light was at the place that was picked.
void draw_review_words(const Pen& pen, const Box& box, const ReviewModel& model);

/// The gate's colours, events, and errors over time, with the moment that is looked at.
void draw_time_line(const Pen& pen, const Box& box, const ReviewModel& model);
/// The moment under a place in it.
double time_at(const Box& box, const Pen& pen, const ReviewModel& model, float x);

}  // namespace planlight
