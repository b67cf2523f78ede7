#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace planlight {

/// The k-th of `count` unit vectors that lie evenly over the sphere, along a spiral of golden angles; of the band
/// between two heights above the equator (-1 to 1) where they are given.
inline Eigen::Vector3d even_direction(int k, int count, double lowest = -1, double highest = 1) {
    const double z = lowest + (highest - lowest) * (k + 0.5) / count, beside = std::sqrt(1 - z * z);
    const double around = k * std::numbers::pi * (3 - std::sqrt(5.0));
    return {beside * std::cos(around), beside * std::sin(around), z};
}

}  // namespace planlight
