#pragma once

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_lut.h"

namespace planlight::test {

/// Even over SO(3), and up to 150 mm of shift per axis.
RigidTransform random_pose(unsigned seed);

/// A cloud in ct, moved into the rig.
PointCloud moved(const PointCloud& cloud_in_ct, const RigidTransform& rig_from_ct);

/// Gaussian noise along the normals, and a share of points replaced by strays in a box round the cloud.
PointCloud spoiled(const PointCloud& cloud, double noise_mm, double stray_share, unsigned seed);

/// Views of the analytic head, in ct.
enum class View { front, left, right, top };
PointCloud head_view(View view, double width_mm, int points, unsigned seed);

/// The table of the analytic head, made once.
const SkinLut& head_lut();

/// The largest displacement of points 60 mm under the middle of the cloud and 40 mm round it, by the pose error:
/// the target registration error, mm.
double target_error_mm(const RigidTransform& ct_from_rig, const RigidTransform& truth, const PointCloud& cloud_in_rig);

/// Points on a sphere, a standing cylinder (side only), a plane: in a frame of their own, with outward normals, all as
/// seen from -y.
PointCloud sphere_view(double radius_mm, int points, unsigned seed);
PointCloud cylinder_view(double radius_mm, double height_mm, int points, unsigned seed);
PointCloud plane_view(double width_mm, int points, unsigned seed);

/// The view with every point moved along its normal by `mm(point, normal)`.
template <class Mm>
PointCloud displaced(PointCloud cloud, const Mm& mm) {
    for (std::size_t i = 0; i < cloud.size(); ++i)
        cloud.points_in_rig[i] += mm(cloud.points_in_rig[i], cloud.normals_in_rig[i]) * cloud.normals_in_rig[i];
    return cloud;
}

}  // namespace planlight::test
