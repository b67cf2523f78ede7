#include "planning_io/types/pose_covariance.h"

#include <cmath>
#include <limits>

#include "planning_io/types/rigid_transform.h"

namespace planlight {

PredictedError predicted_error(const PoseCovariance& covariance, const Eigen::Vector3d& p_in_ct) {
    const Eigen::Matrix<double, 3, 6> J = movement_by_twist(p_in_ct - covariance.centre_in_ct);
    const Eigen::Matrix3d C = J * covariance.of_turn_and_shift * J.transpose();
    const double mean = C.trace();
    if (!std::isfinite(mean)) return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    if (!(mean > 0)) return {};
    // mean * chi^2(n) / n with n = 2 mean^2 / variance; its 95th percentile by Wilson & Hilferty (1931).
    const double variance = 2 * (C * C).trace(), n = 2 * mean * mean / variance;
    constexpr double kNormal95 = 1.6448536;
    const double root = 1 - 2 / (9 * n) + kNormal95 * std::sqrt(2 / (9 * n));
    return {std::sqrt(mean), std::sqrt(mean * root * root * root)};
}

}  // namespace planlight
