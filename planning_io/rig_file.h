#pragma once

#include <filesystem>
#include <string>

#include "planning_io/types/rig_calibration.h"

namespace planlight {

void write_rig(const RigCalibration& rig, const std::filesystem::path& file);

/// rig.json. Nonsense is refused with InputError: not a rotation, focal lengths <= 0, sizes <= 0, NaN, devices that look
/// away from each other, cameras at one place.
RigCalibration read_rig(const std::filesystem::path& file);

/// One device as rig.json holds it (JSON text).
std::string as_json(const CameraModel& device);

}  // namespace planlight
