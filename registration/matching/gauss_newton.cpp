#include "registration/matching/gauss_newton.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace planlight {

using Eigen::Vector3d;

NormalEquations point_to_plane_equations(std::span<const Vector3d> points_in_rig, std::span<const std::uint8_t> skip,
                                         const DistanceField& field, const RigidTransform& ct_from_rig,
                                         const Vector3d& centre_in_ct, double scale_mm, double outside_mm, double max_pair_mm) {
    const Eigen::Matrix3d R = ct_from_rig.linear();
    const Vector3d t = ct_from_rig.translation();
    double sums[27] = {};  // upper triangle of H, then g
    NormalEquations result;
    for (std::size_t i = 0; i < points_in_rig.size(); ++i) {
        if (!skip.empty() && skip[i]) continue;
        const Vector3d x = R * points_in_rig[i] + t;
        double d;
        Vector3d n;
        if (!field.sample(x, d, n) || std::abs(d) > max_pair_mm) continue;
        const double length = n.norm();
        if (length < 0.3) continue;  // a ridge of the field: no side to go to
        n /= length;
        ++result.used;
        const double w = tukey_weight(d, d > 0 ? outside_mm : scale_mm);
        if (w == 0) continue;
        const Vector3d turn = (x - centre_in_ct).cross(n);
        const double J[6] = {turn.x(), turn.y(), turn.z(), n.x(), n.y(), n.z()};
        int s = 0;
        for (int a = 0; a < 6; ++a)
            for (int b = a; b < 6; ++b) sums[s++] += w * J[a] * J[b];
        for (int a = 0; a < 6; ++a) sums[s++] += w * J[a] * d;
    }
    int s = 0;
    for (int a = 0; a < 6; ++a)
        for (int b = a; b < 6; ++b) result.H(a, b) = result.H(b, a) = sums[s++];
    for (int a = 0; a < 6; ++a) result.g(a) = sums[s++];
    return result;
}

RigidTransform after_step(const NormalEquations& equations, const RigidTransform& ct_from_rig, const Vector3d& centre_in_ct,
                          double largest_step_mm, double& moved_mm) {
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

RigidTransform refine_roughly(std::span<const Vector3d> points_in_rig, const Vector3d& centre_in_rig, const DistanceField& field,
                              const RigidTransform& ct_from_rig) {
    constexpr int kSteps = 12;
    constexpr double kLeastScale_mm = 1, kOutside = 0.5;
    RigidTransform pose = ct_from_rig;
    for (int i = 0; i < kSteps; ++i) {
        const double scale_mm = std::max(kLeastScale_mm, 5.0 * std::pow(0.8, i));
        const Vector3d centre_in_ct = pose * centre_in_rig;
        const NormalEquations equations = point_to_plane_equations(points_in_rig, {}, field, pose, centre_in_ct, scale_mm,
                                                                   std::max(kLeastScale_mm, kOutside * scale_mm), 20);
        if (equations.used < 12) return pose;
        double moved_mm;
        pose = after_step(equations, pose, centre_in_ct, 20, moved_mm);
        if (moved_mm < 0.02 && i > 6) break;
    }
    return pose;
}

}  // namespace planlight
