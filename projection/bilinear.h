#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "planning_io/types/image.h"

namespace planlight {

/// The grey between four pixels; NaN outside of their centres. For loops that ask some hundred thousand times a frame.
inline double bilinear_or_nan(const GrayImage& picture, double x, double y) {
    if (!(x >= 0 && y >= 0 && x < picture.width - 1 && y < picture.height - 1))
        return std::numeric_limits<double>::quiet_NaN();
    const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
    const double u = x - static_cast<double>(i), v = y - static_cast<double>(j);
    const std::uint8_t* at = picture.pixels.data() + j * static_cast<std::size_t>(picture.width) + i;
    const std::uint8_t* below = at + picture.width;
    return (1 - v) * ((1 - u) * at[0] + u * at[1]) + v * ((1 - u) * below[0] + u * below[1]);
}

/// The same; empty outside of their centres.
inline std::optional<double> bilinear(const GrayImage& picture, const Eigen::Vector2d& pixel) {
    const double grey = bilinear_or_nan(picture, pixel.x(), pixel.y());
    return std::isnan(grey) ? std::nullopt : std::optional(grey);
}

}  // namespace planlight
