#pragma once

#include "planning_io/case/capture_folder.h"
#include "registration/scan/scan_surface.h"

namespace planlight {

/// The coded light that capture.json says. A Gray code without fringes counts single projector pixels, whatever period
/// is said: its finest cell is half of a period of 2.
StripeSettings stripes_of(const CaptureFolder& folder);

/// The pictures of that light, in its order; without fringes white, black and the Gray bits. Throws InputError when no
/// sequence can be made of it; `named`: the file or folder that said so.
std::vector<StripePattern> patterns_of(const StripeSettings& stripes, const std::filesystem::path& named);

/// Between a scan's frames in memory and a capture folder. Throws InputError when the folder's pictures are not the
/// sequence that its settings make; without fringes, the finest bits or all rows, what is left of it is `partial`.
ScanCapture scan_capture_from(CaptureFolder folder, const std::filesystem::path& named);

/// The pictures are copied.
CaptureFolder capture_folder_from(const ScanCapture& capture);

/// Throws InputError when the pictures or the projector have another size than the rig says, or too few devices are
/// left.
void check_sizes(const ScanCapture& capture, const RigCalibration& rig, const std::filesystem::path& folder);

}  // namespace planlight
