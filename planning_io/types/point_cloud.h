#pragma once

#include <Eigen/Core>
#include <vector>

namespace planlight {

/// Scanned skin points in the rig frame, mm. The optional columns are empty or as long as `points_in_rig`.
struct PointCloud {
    std::vector<Eigen::Vector3d> points_in_rig;
    std::vector<Eigen::Vector3d> normals_in_rig;       ///< unit, towards the devices
    std::vector<float> sigma_mm;                       ///< one standard deviation along the worst direction
    std::vector<Eigen::Vector2d> pixels_in_projector;  ///< the projector pixel (sub-pixel) that lit the point

    std::size_t size() const { return points_in_rig.size(); }
    bool empty() const { return points_in_rig.empty(); }
};

}  // namespace planlight
