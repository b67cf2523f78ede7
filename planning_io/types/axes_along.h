#pragma once

#include <Eigen/Geometry>

namespace planlight {

/// Columns: two axes across, in no direction of their own, then `z` (a unit vector); right-handed.
inline Eigen::Matrix3d axes_along(const Eigen::Vector3d& z) {
    Eigen::Matrix3d axes;
    axes.col(2) = z;
    axes.col(0) = z.unitOrthogonal();
    axes.col(1) = z.cross(axes.col(0));
    return axes;
}

}  // namespace planlight
