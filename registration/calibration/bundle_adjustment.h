#pragma once

#include <array>
#include <vector>

#include "registration/calibration/rig_estimate.h"

namespace planlight {

/// What is adjusted and how strongly it is held.
struct BundleSettings {
    bool sixth_order = false;     ///< also k3: for lenses wider than those of a usual rig
    bool bend = true;             ///< the board may be bent by a fraction of a mm
    double bend_sigma_mm = 0.5;   ///< how much is likely
    double aspect_sigma = 0.003;  ///< of fx / fy about 1: pixels are square, or nearly
    bool rig_fixed = false;       ///< only the poses of the board are found (to judge a rig on poses it has not seen)
    double outlier = 4.5;         ///< sigmas beyond which a corner or lit pixel is left out
    bool light = true;            ///< false: corners only
};

/// Residuals of one device in one pose, pixels.
struct PoseResidual {
    std::size_t pose = 0;
    DeviceName device = DeviceName::left_camera;
    double rms_px = 0;  ///< length of the 2-D residual: corners for a camera, light for the projector
    std::size_t used = 0, left_out = 0;
};

/// The adjusted rig and what the residuals say of it.
struct BundleResult {
    RigEstimate rig;
    bool converged = false;
    std::array<double, 3> sigma_px{};  ///< one standard deviation per axis, by device (projector: of the decoded light)
    std::array<double, 3> rms_px{};    ///< over all, of the length of the 2-D residual, without what was left out
    std::array<std::size_t, 3> used{}, left_out{};
    std::vector<PoseResidual> residuals;
    Eigen::MatrixXd covariance;     ///< of `numbers_of(rig)`; empty when the rig was fixed
    double uncertainty_factor = 1;  ///< how much more the poses contradict each other than the residuals say
};

/// One least-squares adjustment over cameras, projector, lens distortion, board poses and the board's bend. A corner
/// gives the difference in the camera's picture; a lit camera pixel is followed to the board, and from there into the
/// projector, and gives the difference to the decoded pixel. Robust (Huber; what is beyond `outlier` sigmas is left
/// out); the sigmas are estimated from the residuals of each device. Lens terms are held back by weak priors in pixels
/// at the picture's corner. Ceres 2.1; covariance by `covariance_over_poses`.
BundleResult adjust_bundle(const std::vector<PoseObservation>& poses, const BoardSpec& board, const RigEstimate& start,
                           const BundleSettings& settings = {});

}  // namespace planlight
