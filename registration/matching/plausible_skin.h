#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

#include "registration/matching/refine_pose_deformable.h"
#include "registration/matching/skin_patches.h"

// One possible skin between CT and operation, and how likely it is: the inside of `refine_pose_deformable`.
namespace planlight {

/// The skins that are tried: over what length each is alike, and how large each patch's own part is against that.
inline constexpr std::array kCorrelations_mm{10., 15., 22., 33., 50., 75.};
inline constexpr std::array kOwnParts{0.01, 0.1, 1., 10.};

/// How likely one possible skin is (over what length it is alike, how large each patch's own part is), and what pose,
/// covariance, offset and scale are if it is so.
struct PlausibleSkin {
    double log_likelihood = -std::numeric_limits<double>::infinity();
    double variance = 0;  ///< of the field, mm^2
    Eigen::Matrix<double, 6, 1> step =
        Eigen::Matrix<double, 6, 1>::Zero();  ///< from the pose that was given to the best one under such a skin
    Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Vector3d offset_mm =
        Eigen::Vector3d::Zero();  ///< of the whole, and what `uneven` of the normal takes times the other two
    double scale = 1, scale_variance = 0;
};

/// The patches as a linear problem about the pose that was given; turns about `centre`.
struct DeformableProblem {
    Eigen::MatrixXd J;         ///< patches x 6
    Eigen::MatrixX3d offsets;  ///< patches x 3: `offset_basis`
    Eigen::VectorXd residual_mm;
    Eigen::VectorXd own;          ///< of each patch: more where it lies far off
    Eigen::VectorXd growth_mm;    ///< of the distance, when the scan grows to twice its size
    Eigen::MatrixXd squared_mm2;  ///< distances of patches
    Eigen::VectorXd soft;         ///< how far each is likely to move, against the typical one

    DeformableProblem(const std::vector<SkinPatch>& patches, const Eigen::Vector3d& centre,
                      const DeformableSettings& settings);
    /// The covariance of the patches' movement that is alike over this length, for a variance of 1.
    Eigen::MatrixXd alike(double correlation_mm) const;
};

/// Generalised least squares of the pose and of an offset of the whole skin (another threshold, swelling all over),
/// which has a prior; how uneven it is over the directions has one as wide as the offset is large. A field smaller than
/// the least movement is not believed. `alike`: of the problem; `own`: each patch's own variance, against the
/// field's. A log-likelihood of minus infinity where it cannot be solved.
PlausibleSkin judge(const DeformableProblem& problem, const Eigen::MatrixXd& alike, double own,
                    const DeformableSettings& settings);

}  // namespace planlight
