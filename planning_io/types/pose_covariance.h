#pragma once

#include <Eigen/Core>

namespace planlight {

/// How uncertain a pose of the patient is: the covariance of a small turn (rotation vector, radians) about
/// `centre_in_ct` and of a shift (mm), both in ct. Zero: not known.
struct PoseCovariance {
    Eigen::Matrix<double, 6, 6> of_turn_and_shift = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Vector3d centre_in_ct = Eigen::Vector3d::Zero();
    bool known() const { return of_turn_and_shift.trace() > 0; }
};

/// The error that a pose may have at one point of the body.
struct PredictedError {
    double rms_mm = 0;
    double bound_95_mm = 0;  ///< the error is smaller in 95 of 100 cases
};

/// At a point in ct, mm. The length of a Gaussian error vector with covariance J C J^T; its 95 % bound by a gamma
/// distribution of the squared length with the same mean and variance (Satterthwaite 1946).
PredictedError predicted_error(const PoseCovariance& covariance, const Eigen::Vector3d& p_in_ct);

}  // namespace planlight
