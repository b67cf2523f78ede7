#pragma once

#include "registration/calibration/calibrate_rig.h"
#include "registration/calibration/initial_calibration.h"

namespace planlight {

/// What is wrong with the pictures of one pose, where the board was found in them.
std::optional<Refusal> judge_pose_pictures(const PoseObservation& pose, const BoardSpec& board,
                                           const CalibrationSettings& settings = {});

/// What is wrong with the pictures themselves.
std::optional<Refusal> judge_pictures(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                      const CalibrationSettings& settings);

/// What is wrong with the poses of the board: too alike, flat on.
std::optional<Refusal> judge_poses(const RigEstimate& rig, const BoardSpec& board, const CalibrationSettings& settings);

}  // namespace planlight
