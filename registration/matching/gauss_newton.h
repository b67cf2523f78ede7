#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "planning_io/types/rigid_transform.h"
#include "registration/matching/distance_field.h"
#include "registration/matching/point_arrays.h"

namespace planlight {

/// Sums of one linearised step, about `centre_in_ct`: twist = (rotation vector, translation of the centre).
struct NormalEquations {
    Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
    std::size_t used = 0;
};

/// Tukey's biweight of a residual; zero beyond 4.685 scales.
inline double tukey_weight(double residual_mm, double scale_mm) {
    const double u = residual_mm / (4.685 * scale_mm);
    const double v = 1 - u * u;
    return v > 0 ? v * v : 0;
}

/// How the kernels place points given about `points_centre_in_rig`; the step turns about `centre_in_ct`.
match_kernels::Placing placing_of(const RigidTransform& ct_from_rig, const Eigen::Vector3d& points_centre_in_rig,
                                  const DistanceField& field, const Eigen::Vector3d& centre_in_ct);

/// Point to plane on the signed distance (the gradient is the normal) of the first `count` points; those marked in
/// `skip` (if not empty) and farther than `max_pair_mm` take no part. `outside_mm`: the robust scale of points outside
/// of the body.
NormalEquations point_to_plane_equations(const PointArrays& points_in_rig, std::size_t count,
                                         std::span<const std::uint8_t> skip, const DistanceField& field,
                                         const RigidTransform& ct_from_rig, const Eigen::Vector3d& centre_in_ct,
                                         double scale_mm, double outside_mm, double max_pair_mm);

/// The pose after the step that the equations ask for, slightly damped so that a slippery shape does not run away.
/// `largest_step_mm` bounds how far a point 100 mm from the centre moves. `moved_mm` (out): how far it did.
RigidTransform after_step(const NormalEquations& equations, const RigidTransform& ct_from_rig,
                          const Eigen::Vector3d& centre_in_ct, double largest_step_mm, double& moved_mm);

/// A few such steps on few points with a falling robust scale, half as large outside of the body, where cloth lies:
/// from a rough pose (some mm and degrees) to near the minimum.
RigidTransform refine_roughly(const PointArrays& points_in_rig, const DistanceField& field,
                              const RigidTransform& ct_from_rig);

}  // namespace planlight
