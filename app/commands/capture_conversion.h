#pragma once

#include "planning_io/recording_files.h"
#include "registration/scan/scan_surface.h"

namespace planlight {

/// Between a scan's frames in memory and a capture folder. Throws InputError when the folder's pictures are not the
/// sequence that its settings make; without fringes, or without the finest bits, what is left of it is `partial`.
ScanCapture scan_capture_from(const CaptureFolder& folder, const std::filesystem::path& named);
CaptureFolder capture_folder_from(const ScanCapture& capture);

/// Throws InputError when the pictures or the projector have another size than the rig says, or too few devices are left.
void check_sizes(const ScanCapture& capture, const RigCalibration& rig, const std::filesystem::path& folder);

}  // namespace planlight
