#pragma once

#include <Eigen/Geometry>

namespace planlight {

/// The plane between left and right of a head: its normal is (1, yaw, roll) normalised, `aside_mm` to the left of the
/// skull's middle.
struct MiddlePlane {
    Eigen::Vector3d centre_in_ct = Eigen::Vector3d::Zero();
    double yaw = 0, roll = 0, aside_mm = 0;

    Eigen::Vector3d left_in_ct() const { return Eigen::Vector3d(1, yaw, roll).normalized(); }
    /// By over 15 degrees from the patient's own left and right.
    bool looks_aside() const { return !(yaw > -0.27 && yaw < 0.27); }
    /// How far to the left of the plane, mm.
    double left_of(const Eigen::Vector3d& p_in_ct) const { return left_in_ct().dot(p_in_ct - centre_in_ct) - aside_mm; }
    /// Of places in ct.
    Eigen::Affine3d mirror_in_ct() const {
        const Eigen::Vector3d left = left_in_ct();
        Eigen::Affine3d mirror = Eigen::Affine3d::Identity();
        mirror.linear() -= 2 * left * left.transpose();
        mirror.translation() = 2 * (left.dot(centre_in_ct) + aside_mm) * left;
        return mirror;
    }
};

}  // namespace planlight
