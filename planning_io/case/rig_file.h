#pragma once

#include <filesystem>
#include <string>

#include "planning_io/types/rig_calibration.h"

namespace planlight {

/// A rig of two devices at least, the left camera among them; refused with InputError as by `read_rig`.
void write_rig(const RigCalibration& rig, const std::filesystem::path& file);

/// rig.json of both cameras and the projector. Nonsense is refused with InputError: not a rotation, focal lengths <= 0,
/// sizes <= 0, NaN, devices that look away from each other, devices at one place; and a rig that lacks a device.
RigCalibration read_rig(const std::filesystem::path& file);

/// As `read_rig`, but the right camera or the projector may be missing in the file (`present` says so).
RigCalibration read_partial_rig(const std::filesystem::path& file);

/// One device as rig.json holds it (JSON text).
std::string as_json(const CameraModel& device);

}  // namespace planlight
