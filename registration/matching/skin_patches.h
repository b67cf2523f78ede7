#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// A scan point on the skin, or the mean of those of one place.
struct SkinPatch {
    Eigen::Vector3d x_in_ct = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    double distance_mm = 0;
    Eigen::Vector3d turned = Eigen::Vector3d::Zero();   ///< x cross normal, about the origin of ct
    Eigen::Vector3d offsets = Eigen::Vector3d::Zero();  ///< `offset_basis`
    double thickness_mm = 0;                            ///< mean over the points for which it is known
    double known_thickness = 0;
};

/// The scan's points on real skin, each with its signed distance to the tangent plane of the table's nearest point:
/// the distance field is twice as coarse and cuts corners.
std::vector<SkinPatch> points_on_skin(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig);

/// The scan in patches of about equal size, about `count` of them at most; those of fewer than four points are left
/// out. Patches are 6 mm wide, and up to 14 mm where they would hold less than 70 % of the points: where a scan is
/// thin.
std::vector<SkinPatch> patches_of(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                                  int count);

}  // namespace planlight
