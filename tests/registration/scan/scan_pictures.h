#pragma once

#include <filesystem>

#include "registration/scan/scan_surface.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight::scan_rooms {

/// The pictures of registration/scan/ACCURACY.md: patterns.png, camera_and_code.png, cloud_error.png (against the
/// truth), volume_sigma.png (what the calibration leaves, over the working volume).
void write_scan_pictures(const simulation::SimulatedRig& room, const ScanCapture& capture, const ScanResult& scan,
                         const std::filesystem::path& folder);

}  // namespace planlight::scan_rooms
