#pragma once

#include <filesystem>

#include "app/windows/window_settings.h"

namespace planlight {

struct ShownReviewSettings {
    std::filesystem::path case_folder;  ///< empty: where it was when it was recorded
    double at_s = 0;                    ///< the moment that is shown first
    std::filesystem::path picture;      ///< file for a picture of the window, which is then closed; empty: none
    WindowSettings window;              ///< its language and its theme
};

/// Where a picture of that window goes: beside the recording, for its owner alone.
inline constexpr const char* kSnapshotAt = "-at-";
std::filesystem::path snapshot_of(const std::filesystem::path& recording, double at_s);

/// A recorded session in a window, to be scrubbed and stepped through, until it is closed. Throws InputError,
/// DamagedFileError, and DeviceError without a display.
void show_review(const std::filesystem::path& recording, const ShownReviewSettings& settings = {});

}  // namespace planlight
