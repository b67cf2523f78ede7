#pragma once

#include "registration/calibration/calibrate_rig.h"
#include "registration/calibration/initial_calibration.h"

namespace planlight {

/// Cameras adjusted on their corners: each alone, and both together. Says which one does not fit, or that they do not
/// fit each other (mirrored, swapped, moved), and which poses.
std::optional<Refusal> judge_cameras(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                     const BundleResult& cameras, const CalibrationSettings& settings);

/// The whole: focal lengths, the light's residuals, the uncertainty.
std::optional<Refusal> judge_rig(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                 const Calibration& calibration, const CalibrationSettings& settings);

/// What a good calibration would rather not have.
std::vector<std::string> warnings_about(const std::vector<PoseObservation>& poses, const Calibration& calibration);

}  // namespace planlight
