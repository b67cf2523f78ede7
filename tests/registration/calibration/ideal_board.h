#pragma once

#include <random>

#include "planning_io/types/rig_calibration.h"
#include "registration/calibration/calibrate_rig.h"
#include "registration/calibration/observe_pose.h"

namespace planlight::test {

/// A rig as in the paper's room, and poses of a board before it, seen without pictures: corners and lit pixels are
/// computed (by OpenCV's projection, not by ours) and given Gaussian noise.
struct IdealRoom {
    BoardSpec board;
    RigCalibration rig;
    std::vector<RigidTransform> rig_from_board;
    double noise_px = 0.05, light_noise_px = 0.08;

    std::vector<PoseObservation> observe(unsigned seed = 1) const;
};

/// `tilt_deg` of all poses against flat on; every way round, at two distances.
IdealRoom ideal_room(int poses = 8, double tilt_deg = 25, const char* board = "charuco 10x7 25 mm");

/// From these poses of its board, with or without the projector's light.
inline Calibration calibrated(const IdealRoom& room, const std::vector<PoseObservation>& poses, bool projector = true) {
    return calibrate_rig(poses, room.board, projector ? room.rig.projector.width : 0, room.rig.projector.height);
}

}  // namespace planlight::test
