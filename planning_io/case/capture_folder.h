#pragma once

#include <filesystem>
#include <functional>
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
    /// The code's number at the first column and the first row of the projector, of a Gray code without fringes that is
    /// not counted from 0 there (one centred in a larger power of two).
    int begins_at_column = 0, begins_at_row = 0;
    bool check_sequence = true;          ///< false: frames of another order or kind than ours, known to be right
    std::vector<std::string> names;      ///< of the patterns, in order
    std::vector<GrayImage> left, right;  ///< one per name; `right` empty: one camera, no folder right/
    Instant began{}, ended{};
    DeviceSerials serials;  ///< of the devices it was captured with, where they are known
};

/// A new folder, whole or not at all. Throws InputError where a picture is missing, and DiskError.
void write_capture(const CaptureFolder& capture, const std::filesystem::path& folder);

/// How a capture folder is read.
struct ReadCapture {
    bool allow_missing = false;  ///< use what is left without missing pictures (`usable_without`), else refuse them
    std::function<void(double)>
        progress;  ///< share of the pictures that are read, 0 to 1, one call at a time; may be empty
    std::function<void(const std::string&)> warn;  ///< what was left out; may be empty
};

/// Looks for all pictures before it reads the first; reads them side by side. Throws InputError that names all that are
/// missing and what to leave out of `names`. Where `names` is missing the pictures in left/ are the names.
CaptureFolder read_capture(const std::filesystem::path& folder, const ReadCapture& how = {});

/// capture.json by itself, for whoever lays the pictures beside it.
void write_capture_settings(const CaptureFolder& capture, const std::filesystem::path& file);

/// What capture.json says, without the pictures. `names` may be missing there (empty then); `phase_steps`, `rows`,
/// `inverse` and `order_steps` are then, and where they are missing themselves, told by the names, or by those of the
/// pictures in left/.
CaptureFolder read_capture_settings(const std::filesystem::path& file);

}  // namespace planlight
