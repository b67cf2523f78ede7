#pragma once

#include "planning_io/recording_files.h"
#include "registration/scan/scan_surface.h"

namespace planlight {

/// Between a scan's frames in memory and a capture folder. Throws InputError when the folder's pictures are not the
/// sequence that its settings make.
ScanCapture scan_capture_from(const CaptureFolder& folder, const std::filesystem::path& named);
CaptureFolder capture_folder_from(const ScanCapture& capture);

}  // namespace planlight
