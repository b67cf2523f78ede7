#pragma once

#include "planning_io/types/rig_calibration.h"
#include "registration/calibration/calibrate_rig.h"

namespace planlight {

/// How well a rig that was calibrated at another time fits poses of the board that another calibration has placed.
struct RigOnPoses {
    std::array<double, 3> rms_px{};    ///< length of the 2-D difference, by DeviceName, without what was left out
    std::array<double, 3> left_out{};  ///< share that was beyond 4.5 sigma
};

/// `rig` is held; only the poses are fitted to it, beginning where `placed` has them. Of the devices that the rig has.
RigOnPoses rig_on_poses(const RigCalibration& rig, const std::vector<PoseObservation>& poses, const BoardSpec& board,
                        const Calibration& placed);

}  // namespace planlight
