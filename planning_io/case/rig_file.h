#pragma once

#include <filesystem>
#include <string>

#include "planning_io/types/rig_calibration.h"
#include "planning_io/types/rig_state.h"

namespace planlight {

/// A rig of two devices at least, the left camera among them; refused with InputError as by `read_rig`.
void write_rig(const RigCalibration& rig, const std::filesystem::path& file);

/// rig.json of both cameras and the projector. Nonsense is refused with InputError: not a rotation, focal lengths <= 0,
/// sizes <= 0, NaN, devices that look away from each other, devices at one place; and a rig that lacks a device.
RigCalibration read_rig(const std::filesystem::path& file);

/// As `read_rig`, but the right camera or the projector may be missing in the file (`present` says so).
RigCalibration read_partial_rig(const std::filesystem::path& file);

/// What `write_rig` writes, and what `read_partial_rig` makes of it (`file`: for its words). Both throw InputError for
/// a rig that `read_partial_rig` refuses, `rig_of_text` DamagedFileError, too, for text of another version.
std::string text_of(const RigCalibration& rig, const std::filesystem::path& file = {});
RigCalibration rig_of_text(const std::string& text, const std::filesystem::path& file);

/// XXH3-128 over the numbers of all devices, hex: two rig files of one calibration have the same.
std::string hash_of(const RigCalibration& rig);

/// What other files call this rig.
RigName name_of(const RigCalibration& rig);

/// One device as rig.json holds it (JSON text).
std::string as_json(const CameraModel& device);

}  // namespace planlight
