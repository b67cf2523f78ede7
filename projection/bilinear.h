#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "planning_io/types/image.h"

namespace planlight {

/// The grey between four pixels; empty outside of their centres.
inline std::optional<double> bilinear(const GrayImage& picture, const Eigen::Vector2d& pixel) {
    const double x = std::floor(pixel.x()), y = std::floor(pixel.y());
    if (!(x >= 0 && y >= 0 && x + 1 < picture.width && y + 1 < picture.height)) return std::nullopt;
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const double u = pixel.x() - x, v = pixel.y() - y;
    return (1 - v) * ((1 - u) * picture.at(i, j) + u * picture.at(i + 1, j)) +
           v * ((1 - u) * picture.at(i, j + 1) + u * picture.at(i + 1, j + 1));
}

}  // namespace planlight
