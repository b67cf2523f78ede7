#pragma once

#include <optional>

#include "planning_io/types/camera_model.h"

namespace planlight {

/// The point halfway between two rays of one frame, where they come nearest to each other, mm.
///
/// Empty when they are within a thousandth of a radian of parallel, or the point lies behind a device.
/// Midpoint method (Hartley & Zisserman, 12.2).
std::optional<Eigen::Vector3d> between_rays(const Ray& a, const Ray& b);

}  // namespace planlight
