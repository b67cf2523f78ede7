#pragma once

#include <optional>
#include <vector>

#include "registration/calibration/calibrate_rig.h"

namespace planlight::test {

/// Real captures of others, as observed by us, with the calibration published with them.
struct RealCaptures {
    BoardSpec board;
    std::vector<PoseObservation> poses;
    int projector_width = 0, projector_height = 0;
    RigEstimate published;  ///< devices only
};

/// The usual ones, but three poses of a board whose unit is unknown (a third of a mm, if it is printed on A4) may leave
/// more in doubt.
CalibrationSettings settings_for_real_captures();

/// 13 stereo pairs of OpenCV's documentation; the left camera's intrinsics are published. Empty when not on this
/// machine.
std::optional<RealCaptures> stereo_pairs();

/// Three poses under 42 Gray-code pictures, one camera and a projector (kamino410/procam-calibration, MIT); published
/// from these and two more poses. Empty when not on this machine.
std::optional<RealCaptures> camera_and_projector();

}  // namespace planlight::test
