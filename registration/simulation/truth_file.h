#pragma once

#include <string>
#include <vector>

#include "registration/simulation/simulated_rig.h"

namespace planlight::simulation {

/// All that the simulator knows and the product must not.
struct TruthNumbers {
    RoomSettings settings;
    Instant at{};
    RigidTransform rig_from_ct;
    std::vector<Eigen::Vector3d> markers_in_ct, marker_normals_in_ct;
    std::vector<bool> markers_covered;
    RigCalibration true_rig, calibration;
    double left_blur_px = 0, right_blur_px = 0, gain = 0;
};

/// The truth file's text (ROOM.md).
std::string as_json(const TruthNumbers& truth);

/// The devices of a rig, in the words of the truth file.
std::string rig_as_json(const RigCalibration& rig);

}  // namespace planlight::simulation
