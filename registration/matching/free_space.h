#pragma once

#include <cstddef>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// Whether the space that the scan saw through is free in the CT as well.
struct FreeSpace {
    std::size_t looked = 0;   ///< rays that were followed
    std::size_t blocked = 0;  ///< of these, through the body before they reach their point
    double blocked_fraction() const {
        return looked == 0 ? 0 : static_cast<double>(blocked) / static_cast<double>(looked);
    }
};

/// Follows the light back from up to 2000 points of the scan to `viewpoint_in_rig` (a device that saw or lit all of
/// them) through the table's distances. A point in the body itself is not looked at (`CloudOnSkin::inside` counts it),
/// nor is what lies beyond the table; `tolerance_mm` deep is not yet through the body.
FreeSpace look_along_rays(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                          const Eigen::Vector3d& viewpoint_in_rig, double tolerance_mm = 3);

}  // namespace planlight
