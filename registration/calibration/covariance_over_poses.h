#pragma once

#include <Eigen/Core>
#include <vector>

namespace planlight {

/// What one pose says of the numbers that all poses share, its own numbers eliminated (residuals in sigmas).
struct PoseInformation {
    Eigen::MatrixXd normal;  ///< J^T J
    Eigen::VectorXd score;   ///< J^T r
};

/// Of the shared numbers, already widened by `factor`.
struct CovarianceOverPoses {
    Eigen::MatrixXd covariance;
    /// How much more the numbers change when a pose is left out than the residuals say if each counts by itself.
    double factor = 1;
};

/// The inverse of the normal matrix, widened by how much the poses contradict each other. Errors that are alike within
/// a pose (of neighbouring corners, of its light) show in nothing else: to the normal matrix each residual counts by
/// itself. The jackknife that leaves out one pose at a time, to first order (CR3: Bell & McCaffrey 2002). Few poses say
/// little of a single direction, so each is moderated by the factor that all have in common (never under 1), as by one
/// pose more (as variances are in Smyth 2004). `prior`: the part of the normal matrix that comes from no pose. Under
/// three poses: the inverse alone.
CovarianceOverPoses covariance_over_poses(const std::vector<PoseInformation>& poses, const Eigen::MatrixXd& prior);

}  // namespace planlight
