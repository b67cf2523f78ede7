#pragma once

#include "planning_io/case/capture_folder.h"

namespace planlight {

/// A capture folder whose devices are those of the rig. Throws CheckFailedError when it names another serial than
/// rig.json, or its pictures or its projector have another size; what one of the two does not say is not compared.
CaptureFolder read_capture_of(const RigCalibration& rig, const std::filesystem::path& folder,
                              const ReadCapture& how = {});

/// `given` by a person and `said` by capture.json as one. Throws InputError where both say something else.
DeviceSerials joined_serials(DeviceSerials given, const DeviceSerials& said, const std::filesystem::path& folder);

}  // namespace planlight
