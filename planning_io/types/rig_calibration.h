#pragma once

#include <string>

#include "planning_io/types/camera_model.h"

namespace planlight {

/// A rig may lack its right camera or its projector: a `CameraModel{}` stands there.
inline bool present(const CameraModel& device) {
    return device.width != 0 || device.focal_x != 0;
}

/// What is written on the devices; empty: not known.
struct DeviceSerials {
    std::string left_camera, right_camera, projector;
    bool operator==(const DeviceSerials&) const = default;
};

/// Both cameras and the projector in one frame, as calibrated.
struct RigCalibration {
    CameraModel left_camera, right_camera, projector;
    std::string made_on;             ///< ISO 8601 date of the calibration
    double reprojection_rms_px = 0;  ///< of the calibration, all devices
    DeviceSerials serials;           ///< of the devices that were calibrated

    bool whole() const { return present(left_camera) && present(right_camera) && present(projector); }
};

}  // namespace planlight
