#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "planning_io/types/rig_calibration.h"
#include "planning_io/types/time.h"

namespace planlight {

/// A capture folder: capture.json and left/NAME.png, right/NAME.png, one per pattern (format in the room's README).
/// Read are .png, .tif and .tiff, written .png.
struct CaptureFolder {
    int projector_width = 0, projector_height = 0;
    int phase_steps = 8;
    double phase_period_px = 16;
    std::vector<double>
        order_periods_px;  ///< of further fringes that take the place of the Gray code; empty: Gray code
    int order_steps = 5;   ///< shifts of each of them
    bool rows = true, inverse = true;
    bool check_sequence = true;          ///< false: frames of another order or kind than ours, known to be right
    std::vector<std::string> names;      ///< of the patterns, in order
    std::vector<GrayImage> left, right;  ///< one per name; `right` empty: one camera, no folder right/
    Instant began{}, ended{};
    DeviceSerials serials;  ///< of the devices it was captured with, where they are known
};
void write_capture(const CaptureFolder& capture, const std::filesystem::path& folder);
CaptureFolder read_capture(const std::filesystem::path& folder);

/// capture.json by itself, for whoever lays the pictures beside it.
void write_capture_settings(const CaptureFolder& capture, const std::filesystem::path& file);

/// What capture.json says, without the pictures. `names` may be missing there (empty then).
CaptureFolder read_capture_settings(const std::filesystem::path& file);

}  // namespace planlight
