#pragma once

#include <random>

#include "planning_io/types/rig_calibration.h"
#include "registration/simulation/optics.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight::simulation {

/// The devices in the room. Room frame: the origin is the working point, z runs away from the projector, y down.
struct RigLayout {
    Optics left_camera, right_camera, projector;
    RigidTransform room_from_rig = RigidTransform::Identity();
    double left_blur_px = 0.6, right_blur_px = 0.6;  ///< sigma of the camera lens
    double working_distance_mm = 900;
    Instant frame_interval{}, exposure{};
};

/// A rig of the preset, each a little different.
RigLayout build_rig(Preset preset, std::mt19937& random);

/// The rig in the product's words.
RigCalibration exported(const RigLayout& rig);

/// The rig as a good calibration would have found it: a little wrong in every lens value, and placed so that it fits
/// its own pictures in the working volume nonetheless. `scale` 1: cameras about 0.06 px, projector about 0.12 px.
RigCalibration calibrated(const RigLayout& rig, double scale, std::mt19937& random);

}  // namespace planlight::simulation
