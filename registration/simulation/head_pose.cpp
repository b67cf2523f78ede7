#include "registration/simulation/head_pose.h"

#include <algorithm>
#include <cmath>

namespace planlight::simulation {

using Eigen::Vector3d;

namespace {

/// The middle of what the projector sees of the head's box when it looks against `outwards`.
Vector3d seen_from(const TrueSurface& skin, const Vector3d& direction) {
    const Vector3d middle = skin.middle_in_ct();
    const auto hit = skin.first_hit(middle + 600 * direction, -direction);
    return hit ? hit->p_in_ct : skin.nearest(middle + 150 * direction).p_in_ct;
}

}  // namespace

WorkRegion find_work_region(const TrueSurface& skin, const std::vector<Vector3d>& plan_points) {
    const Vector3d anterior(0, -1, 0);
    if (plan_points.empty()) return {seen_from(skin, anterior), anterior};
    Vector3d centre = Vector3d::Zero(), normals = Vector3d::Zero();
    for (const Vector3d& p : plan_points) {
        const auto on_skin = skin.nearest(p);
        centre += on_skin.p_in_ct / static_cast<double>(plan_points.size());
        normals += on_skin.normal_in_ct;
    }
    // The local normal may belong to a dent: the way out of the head's middle has half the say.
    const Vector3d outwards = (normals.normalized() + (centre - skin.middle_in_ct()).normalized()).normalized();
    return {skin.nearest(centre).p_in_ct, outwards};
}

RigidTransform lay_head(const TrueSurface& skin, const WorkRegion& region, std::mt19937& random) {
    std::uniform_real_distribution<double> unit(0, 1), jitter(-12, 12);
    const double least = std::cos(28 * M_PI / 180);
    const double cosine = least + (1 - least) * unit(random), sine = std::sqrt(1 - cosine * cosine);
    const double around = 2 * M_PI * unit(random), roll = 2 * M_PI * unit(random);
    const Vector3d facing(sine * std::cos(around), sine * std::sin(around),
                          -cosine);  // room z runs away from the light
    const Eigen::Quaterniond towards = Eigen::Quaterniond::FromTwoVectors(region.outwards_in_ct, facing);
    RigidTransform room_from_ct = RigidTransform::Identity();
    room_from_ct.linear() = (Eigen::AngleAxisd(roll, facing) * towards).toRotationMatrix();
    // Sideways between the region and the head's middle, in depth at the region.
    const Vector3d centre = room_from_ct.linear() * region.centre_in_ct,
                   middle = room_from_ct.linear() * skin.middle_in_ct();
    const Vector3d anchor(0.5 * (centre.x() + middle.x()), 0.5 * (centre.y() + middle.y()), centre.z() + 15);
    room_from_ct.translation() = Vector3d(jitter(random), jitter(random), jitter(random)) - anchor;
    return room_from_ct;
}

}  // namespace planlight::simulation
