#include "planning_io/types/rigid_transform.h"

namespace planlight {

RigidTransform transform_from_twist(const Eigen::Matrix<double, 6, 1>& twist) {
    const Eigen::Vector3d omega = twist.head<3>();
    const double angle = omega.norm();
    RigidTransform result = RigidTransform::Identity();
    if (angle > 0) result.linear() = Eigen::AngleAxisd(angle, omega / angle).toRotationMatrix();
    result.translation() = twist.tail<3>();
    return result;
}

Eigen::Matrix<double, 3, 6> movement_by_twist(const Eigen::Vector3d& r) {
    Eigen::Matrix<double, 3, 6> J;
    J << 0, r.z(), -r.y(), 1, 0, 0, -r.z(), 0, r.x(), 0, 1, 0, r.y(), -r.x(), 0, 0, 0, 1;
    return J;
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R) {
    const Eigen::AngleAxisd angle_axis(R);
    return angle_axis.angle() * angle_axis.axis();
}

double angle_between(const RigidTransform& a, const RigidTransform& b) {
    return Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle();
}

RigidTransform fit_rigid_transform(const Eigen::Matrix3Xd& points_in_a, const Eigen::Matrix3Xd& points_in_b) {
    return RigidTransform(Eigen::umeyama(points_in_a, points_in_b, false));
}

bool is_rigid(const Eigen::Matrix4d& matrix, double tolerance) {
    if (!matrix.allFinite()) return false;
    const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
    const bool orthonormal = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < tolerance;
    const bool last_row = (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() < tolerance;
    return orthonormal && last_row && R.determinant() > 0;
}

}  // namespace planlight
