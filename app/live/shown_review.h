#pragma once

#include <filesystem>
#include <memory>

#include "app/words/words.h"

namespace planlight {

struct ShownReviewSettings {
    std::filesystem::path case_folder;   ///< empty: where it was when it was recorded
    double at_s = 0;                     ///< the moment that is shown first
    std::filesystem::path picture;       ///< file for a picture of the window, which is then closed; empty: none
    std::shared_ptr<const Words> words;  ///< null: English
};

/// A recorded session in a window, to be scrubbed and stepped through, until it is closed. Throws InputError,
/// DamagedFileError, and DeviceError without a display.
void show_review(const std::filesystem::path& recording, const ShownReviewSettings& settings = {});

}  // namespace planlight
