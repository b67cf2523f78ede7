#pragma once

#include <optional>
#include <vector>

#include "registration/calibration/calibrate_rig.h"

namespace planlight {

/// A device that was moved before the last pose or after the first contradicts one pose only: a small share of all that
/// was seen, which no median feels.
/// `settings` are those that `bundle` was adjusted by.
std::optional<Refusal> judge_odd_poses(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                       const BundleResult& bundle, const BundleSettings& settings);

}  // namespace planlight
