#include "registration/calibration/covariance_over_poses.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Directions of which a pose tells all but this share alone: its residuals say nothing of its error there.
constexpr double kLeastTold = 0.02;
/// The factor that all directions have in common counts as one pose more: few say little of a single direction.
constexpr double kPosesOfCommonFactor = 1;

/// The poses' scores where the sum of all information is the unit matrix.
struct Whitened {
    MatrixXd outer;     ///< sum of the outer products of the scores, each as large as its information says if all is well
    MatrixXd expected;  ///< of `outer` if all is well
};

Whitened whitened_scores(const std::vector<PoseInformation>& poses, const MatrixXd& whitener) {
    const auto n = whitener.rows();
    Whitened sum{MatrixXd::Zero(n, n), MatrixXd::Zero(n, n)};
    for (const PoseInformation& pose : poses) {
        const Eigen::SelfAdjointEigenSolver<MatrixXd> own(whitener * pose.normal * whitener.transpose());
        VectorXd stretch = VectorXd::Zero(n), told = VectorXd::Zero(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const double share = own.eigenvalues()[i];
            if (share < 1e-9 || 1 - share < kLeastTold) continue;
            stretch[i] = 1 / std::sqrt(1 - share);
            told[i] = share;
        }
        const MatrixXd& axes = own.eigenvectors();
        const VectorXd score = axes * stretch.asDiagonal() * axes.transpose() * (whitener * pose.score);
        sum.outer += score * score.transpose();
        sum.expected += axes * told.asDiagonal() * axes.transpose();
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
    // covariance = unwhitener * (what the whitened scores scatter) * its transpose
    const MatrixXd whitener =
        axes.eigenvalues().cwiseMax(1e-15).cwiseSqrt().cwiseInverse().asDiagonal() * axes.eigenvectors().transpose() *
        scale.asDiagonal();
    CovarianceOverPoses result;
    MatrixXd scatter = unit;
    if (poses.size() >= 3) {
        const Whitened scores = whitened_scores(poses, whitener);
        const double as_seen = scores.outer.trace() / std::max(1e-9, scores.expected.trace());
        const double factor_2 = std::max(1.0, as_seen);
        const MatrixXd not_told = unit - scores.expected;  // priors, and what one pose alone tells
        const MatrixXd seen = factor_2 * (scores.outer / std::max(1e-9, as_seen) + not_told);
        const auto count = static_cast<double>(poses.size());
        scatter = (kPosesOfCommonFactor * factor_2 * unit + count * seen) / (kPosesOfCommonFactor + count);
        result.factor = std::sqrt(factor_2);
    }
    result.covariance = whitener.transpose() * scatter * whitener;
    return result;
}

}  // namespace planlight
