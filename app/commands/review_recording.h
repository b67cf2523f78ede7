#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace planlight {

/// What of a recorded session is to be looked at.
struct RecordingReviewOptions {
    std::filesystem::path recording;
    std::filesystem::path case_folder;  ///< for `at_s`; empty: where it was when it was recorded
    std::filesystem::path out;          ///< folder, new, empty or of a former review; empty: beside the recording
    double at_s = -1;                   ///< of a picture; below 0: none
    std::vector<double> clip_s;         ///< from, to; empty: none
    bool json = false;
    bool show = false;              ///< in a window, and nothing is written
    std::filesystem::path picture;  ///< of that window, which is then closed; empty: none
    std::string language, theme;    ///< of the window; empty: the site's
};

/// Whether this is a recording and not a case.
bool is_recording(const std::filesystem::path& path);

/// Where its review stands when no other folder was named.
std::filesystem::path review_folder_of(const std::filesystem::path& recording);

/// `planlight review RECORDING --show`. Gives the exit code.
int show_recording(const RecordingReviewOptions& options);

/// `planlight review RECORDING`: its page, then the pictures that were asked for. Gives the exit code.
int run_recording_review(const RecordingReviewOptions& options);

}  // namespace planlight
