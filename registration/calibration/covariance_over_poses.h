#pragma once

#include <Eigen/Core>
#include <vector>

namespace planlight {

/// What one pose says of the numbers that all poses share, its own numbers eliminated (residuals in sigmas).
struct PoseInformation {
    Eigen::MatrixXd normal;  ///< J^T J
    Eigen::VectorXd score;   ///< J^T r
};

struct CovarianceOverPoses {
    Eigen::MatrixXd covariance;
    /// How much more the poses contradict each other than their residuals say if every one counts by itself (1: as they say).
    double factor = 1;
};

/// The inverse of the normal matrix, widened by how much the poses contradict each other. Errors that are alike within a pose
/// (of neighbouring corners, of its light) show in nothing else: to the normal matrix each residual counts by itself.
/// Sandwich over poses, free of bias where the residuals are independent (CR2: Bell & McCaffrey 2002). Few poses say little of
/// a single direction, so each is moderated by the factor that all have in common (never under 1), as by one pose more
/// (as variances are in Smyth 2004).
/// `prior`: the part of the normal matrix that comes from no pose. Under three poses: the inverse alone.
CovarianceOverPoses covariance_over_poses(const std::vector<PoseInformation>& poses, const Eigen::MatrixXd& prior);

}  // namespace planlight
