#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "planning_io/types/image.h"

namespace planlight {

/// A projector's light grows with this power of a picture's numbers (sRGB, and nearly every projector; what yours does
/// `planlight projector` measures). Half a number would be a fifth of the light.
inline constexpr double kPanelGamma = 2.2;

/// The number of a picture that gives `share` (0 to 1) of the light of the number `full`.
std::uint8_t number_for_light(std::uint8_t full, double share);

/// Fills small shapes with exact pixel coverage. Shapes of one stroke add up (shared edges leave no seam),
/// and are then laid on the picture as one. A pixel that is half covered gives half the light.
///
/// Pixel (0,0) is the centre of the top-left pixel: a pixel covers half a pixel to each side of its centre.
class StrokeRaster {
public:
    StrokeRaster(int width, int height);

    void add_quad(const std::array<Eigen::Vector2d, 4>& corners) { add(corners, {}); }
    /// Closed outlines filled together: one that runs the other way round cuts a hole.
    void add_outlines(const std::vector<std::vector<Eigen::Vector2d>>& outlines) { add({}, outlines); }
    /// Lays what was added on `picture` (brighter channel wins) and starts anew. Returns how many pixels it touched.
    std::size_t flush(Rgb colour, RgbImage& picture);

private:
    void add(std::span<const Eigen::Vector2d> outline, std::span<const std::vector<Eigen::Vector2d>> more);
    void add_edge(Eigen::Vector2d from, Eigen::Vector2d to);

    int width_, height_;
    std::vector<float> coverage_;
    std::vector<std::size_t> touched_;
    std::vector<float> area_;  ///< of one shape: signed area, to be summed along rows
    int area_width_ = 0, area_height_ = 0;
};

}  // namespace planlight
