#include "registration/matching/free_space.h"

#include <algorithm>
#include <cmath>

#include "registration/matching/distance_field.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// Whether the way from `from` towards `to` leads deeper than `tolerance_mm` into the body. The distance bounds how far
/// the next skin is, so that free space is crossed in few steps.
bool through_the_body(const DistanceField& field, const Vector3d& from, const Vector3d& to, double tolerance_mm) {
    constexpr double kLeastStep_mm = 1, kFarthest_mm = 600;
    const double length_mm = std::min((to - from).norm(), kFarthest_mm);
    const Vector3d way = (to - from).normalized();
    double d;
    Vector3d unused;
    for (double along_mm = 0; along_mm < length_mm && field.sample(from + along_mm * way, d, unused);
         along_mm += std::max(kLeastStep_mm, d))
        if (d < -tolerance_mm) return true;
    return false;
}

}  // namespace

FreeSpace look_along_rays(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                          const Vector3d& viewpoint_in_rig, double tolerance_mm) {
    constexpr std::size_t kRays = 2000;
    FreeSpace result;
    if (lut.distance_mm.empty()) return result;
    const DistanceField field(lut);
    const Vector3d viewpoint_in_ct = ct_from_rig * viewpoint_in_rig;
    const std::size_t stride = std::max<std::size_t>(1, cloud.size() / kRays);
    for (std::size_t i = 0; i < cloud.size(); i += stride) {
        if (!cloud.points_in_rig[i].allFinite()) continue;
        const Vector3d p = ct_from_rig * cloud.points_in_rig[i];
        double d;
        Vector3d unused;
        if (!field.sample(p, d, unused) || d < -tolerance_mm) continue;
        ++result.looked;
        result.blocked += through_the_body(field, p, viewpoint_in_ct, tolerance_mm);
    }
    return result;
}

}  // namespace planlight
