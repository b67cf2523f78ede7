#pragma once

#include <Eigen/Core>
#include <string>

#include "planning_io/types/image.h"

namespace planlight {

/// Writes one line of text (UTF-8) in strokes into a picture: its middle at `middle` (pixels), capitals `height` pixels
/// high.
void write_line(const std::string& text, const Eigen::Vector2d& middle, double height, Rgb colour, RgbImage& picture);

}  // namespace planlight
