#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/triangle_mesh.h"

namespace planlight::test {

/// How well a surface meets points of the true skin.
struct OffSkin {
    std::size_t asked = 0;             ///< points that were counted
    std::vector<Eigen::Vector3d> off;  ///< those further off than `more_than_mm`, in ct
    double percent() const;            ///< not a number when none was counted
};

/// `points` of the skin in ct against a surface. What lies behind a lid (nostril, ear, mouth) or an end of the volume
/// is flagged as no skin by the surface itself, and is not counted.
OffSkin off_skin(const std::vector<Eigen::Vector3d>& points, const TriangleMesh& skin, double more_than_mm = 2);

}  // namespace planlight::test
