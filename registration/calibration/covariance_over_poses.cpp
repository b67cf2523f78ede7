#include "registration/calibration/covariance_over_poses.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Directions of which one pose tells all but this share: leaving it out leaves nothing to compare with.
constexpr double kLeastTold = 0.02;
/// The factor that all directions have in common counts as one pose more: few say little of a single direction.
constexpr double kPosesOfCommonFactor = 1;

/// In coordinates in which the sum of all information is the unit matrix.
struct LeftOut {
    MatrixXd outer;  ///< sum over the poses of d d^T, d by how much the numbers change when the pose is left out
    MatrixXd told;   ///< the information of the poses, but for what a single one tells
};

LeftOut leave_each_out(const std::vector<PoseInformation>& poses, const MatrixXd& whitener) {
    const auto n = whitener.rows();
    LeftOut sum{MatrixXd::Zero(n, n), MatrixXd::Zero(n, n)};
    for (const PoseInformation& pose : poses) {
        const Eigen::SelfAdjointEigenSolver<MatrixXd> own(whitener * pose.normal * whitener.transpose());
        VectorXd stretch = VectorXd::Zero(n), told = VectorXd::Zero(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const double share = own.eigenvalues()[i];
            if (share < 1e-9 || 1 - share < kLeastTold) continue;
            stretch[i] = 1 / (1 - share);
            told[i] = share;
        }
        const MatrixXd& axes = own.eigenvectors();
        const VectorXd change = axes * stretch.asDiagonal() * axes.transpose() * (whitener * pose.score);
        sum.outer += change * change.transpose();
        sum.told += axes * told.asDiagonal() * axes.transpose();
    }
    return sum;
}

}  // namespace

CovarianceOverPoses covariance_over_poses(const std::vector<PoseInformation>& poses, const MatrixXd& prior) {
    MatrixXd normal = prior;
    for (const PoseInformation& pose : poses) normal += pose.normal;
    const auto n = normal.rows();
    const MatrixXd unit = MatrixXd::Identity(n, n);
    const VectorXd scale = normal.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(scale.asDiagonal() * normal * scale.asDiagonal());
    const MatrixXd whitener = axes.eigenvalues().cwiseMax(1e-15).cwiseSqrt().cwiseInverse().asDiagonal() *
                              axes.eigenvectors().transpose() * scale.asDiagonal();
    CovarianceOverPoses result;
    MatrixXd scatter = unit;
    if (poses.size() >= 3) {
        const LeftOut left_out = leave_each_out(poses, whitener);
        const double as_seen = left_out.outer.trace() / std::max(1e-9, left_out.told.trace());
        const double factor_2 = std::max(1.0, as_seen);
        const MatrixXd not_told = unit - left_out.told;  // priors, and what one pose alone tells
        const MatrixXd seen = factor_2 * (left_out.outer / std::max(1e-9, as_seen) + not_told);
        const auto count = static_cast<double>(poses.size());
        scatter = (kPosesOfCommonFactor * factor_2 * unit + count * seen) / (kPosesOfCommonFactor + count);
        result.factor = std::sqrt(factor_2);
    }
    result.covariance = whitener.transpose() * scatter * whitener;
    return result;
}

}  // namespace planlight
