#pragma once

#include <Eigen/Geometry>

namespace planlight {

/// Rotation and translation in mm. Named `b_from_a`: `p_in_b = b_from_a * p_in_a`.
using RigidTransform = Eigen::Isometry3d;

/// The transform of a twist (rotation vector in radians, then translation in mm): the rotation is applied first,
/// the translation is added after it. Zero gives identity.
RigidTransform transform_from_twist(const Eigen::Matrix<double, 6, 1>& twist);

/// How a point moves with a small twist about a centre: d(p) / d(rotation vector, translation) = (-[r]x, I), where `r`
/// goes from the centre to the point.
Eigen::Matrix<double, 3, 6> movement_by_twist(const Eigen::Vector3d& r);

/// The rotation vector of `R` (radians, angle in [0, pi]).
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R);

/// The angle (radians, [0, pi]) of the rotation between two transforms of the same name.
double angle_between(const RigidTransform& a, const RigidTransform& b);

/// The least-squares rigid transform with `b ~= b_from_a * a`, weights equal (Horn 1987; Umeyama 1991 without scale).
/// Columns are corresponding points, mm; at least 3, not on one line, or the rotation is not determined.
RigidTransform fit_rigid_transform(const Eigen::Matrix3Xd& points_in_a, const Eigen::Matrix3Xd& points_in_b);

/// True when the linear part is a rotation to `tolerance` (orthonormal, determinant +1) and all is finite.
bool is_rigid(const Eigen::Matrix4d& matrix, double tolerance = 1e-6);

}  // namespace planlight
