#pragma once

#include <Eigen/Core>
#include <optional>

#include "projection/skin_surface.h"

namespace planlight {

/// The plane that mirrors a head onto itself: `normal_in_ct` points to the patient's left.
struct MidPlane {
    Eigen::Vector3d point_in_ct, normal_in_ct;
    double residual_mm = 0;  ///< median distance of mirrored skin from skin
    double left_mm(const Eigen::Vector3d& p_in_ct) const { return normal_in_ct.dot(p_in_ct - point_in_ct); }
};

/// Fits the plane by matching the mirrored skin to the skin, from the plane across the middle of the skin's box (LPS: x
/// is left). Empty when what was found is tilted by more than 35 degrees or mirrors the skin no better than 6 mm: then
/// nobody can tell left from right by it.
std::optional<MidPlane> find_mid_plane(const SkinSurface& skin);

}  // namespace planlight
