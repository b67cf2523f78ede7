#include "registration/matching/gauss_newton.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace planlight {

using Eigen::Vector3d;

match_kernels::Placing placing_of(const RigidTransform& ct_from_rig, const Vector3d& points_centre_in_rig,
                                  const DistanceField& field, const Vector3d& centre_in_ct) {
    match_kernels::Placing placing;
    const Vector3d centre = ct_from_rig * points_centre_in_rig;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) placing.R[3 * r + c] = static_cast<float>(ct_from_rig.linear()(r, c));
        placing.shift[r] = static_cast<float>(centre[r] - field.origin_in_ct()[r]);
        placing.arm_shift[r] = static_cast<float>(centre[r] - centre_in_ct[r]);
    }
    return placing;
}

NormalEquations point_to_plane_equations(const PointArrays& points, std::size_t count,
                                         std::span<const std::uint8_t> skip, const DistanceField& field,
                                         const RigidTransform& ct_from_rig, const Vector3d& centre_in_ct,
                                         double scale_mm, double outside_mm, double max_pair_mm) {
    double sums[27] = {};  // upper triangle of H, then g
    NormalEquations result;
    result.used = match_kernels::add_point_to_plane(
        points.x.data(), points.y.data(), points.z.data(), skip.empty() ? nullptr : skip.data(), count, field.plain(),
        placing_of(ct_from_rig, points.centre, field, centre_in_ct),
        {static_cast<float>(scale_mm), static_cast<float>(outside_mm), static_cast<float>(max_pair_mm)}, sums);
    int s = 0;
    for (int a = 0; a < 6; ++a)
        for (int b = a; b < 6; ++b) result.H(a, b) = result.H(b, a) = sums[s++];
    for (int a = 0; a < 6; ++a) result.g(a) = sums[s++];
    return result;
}

RigidTransform after_step(const NormalEquations& equations, const RigidTransform& ct_from_rig,
                          const Vector3d& centre_in_ct, double largest_step_mm, double& moved_mm) {
    constexpr double kLever_mm = 100;
    Eigen::Matrix<double, 6, 6> H = equations.H;
    const double trace = H.diagonal().tail<3>().sum() + 1e-12;
    H.diagonal().head<3>().array() += 1e-7 * trace * kLever_mm * kLever_mm;
    H.diagonal().tail<3>().array() += 1e-7 * trace;
    Eigen::Matrix<double, 6, 1> step = -H.ldlt().solve(equations.g);
    if (!step.allFinite()) step.setZero();
    moved_mm = step.head<3>().norm() * kLever_mm + step.tail<3>().norm();
    if (moved_mm > largest_step_mm) {
        step *= largest_step_mm / moved_mm;
        moved_mm = largest_step_mm;
    }
    const RigidTransform about_centre = transform_from_twist(step);
    return Eigen::Translation3d(centre_in_ct) * about_centre * Eigen::Translation3d(-centre_in_ct) * ct_from_rig;
}

RigidTransform refine_roughly(const PointArrays& points_in_rig, const DistanceField& field,
                              const RigidTransform& ct_from_rig) {
    constexpr int kSteps = 12;
    constexpr double kLeastScale_mm = 1, kOutside = 0.5;
    RigidTransform pose = ct_from_rig;
    for (int i = 0; i < kSteps; ++i) {
        const double scale_mm = std::max(kLeastScale_mm, 5.0 * std::pow(0.8, i));
        const Vector3d centre_in_ct = pose * points_in_rig.centre;
        const NormalEquations equations =
            point_to_plane_equations(points_in_rig, points_in_rig.size(), {}, field, pose, centre_in_ct, scale_mm,
                                     std::max(kLeastScale_mm, kOutside * scale_mm), 20);
        if (equations.used < 12) return pose;
        double moved_mm;
        pose = after_step(equations, pose, centre_in_ct, 20, moved_mm);
        if (moved_mm < 0.02 && i > 6) break;
    }
    pose.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
    return pose;
}

}  // namespace planlight
