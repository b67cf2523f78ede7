#pragma once

#include <string>

#include "planning_io/types/camera_model.h"

namespace planlight {

/// Both cameras and the projector in one frame, as calibrated.
struct RigCalibration {
    CameraModel left_camera, right_camera, projector;
    std::string made_on;               ///< ISO 8601 date of the calibration
    double reprojection_rms_px = 0;    ///< of the calibration, all devices
};

}  // namespace planlight
