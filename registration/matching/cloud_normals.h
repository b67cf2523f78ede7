#pragma once

#include "planning_io/types/point_cloud.h"

namespace planlight {

/// Gives a cloud without normals those of its local planes: principal axes of the neighbours within the smallest radius
/// (2 to 12 mm) that holds a dozen for most points. Each faces the viewpoint (rig, mm): where the devices that made the
/// scan stood. Points that are not finite, or have fewer than five neighbours, are taken out, and so are the other
/// columns.
PointCloud with_normals(const PointCloud& cloud, const Eigen::Vector3d& viewpoint_in_rig);

}  // namespace planlight
