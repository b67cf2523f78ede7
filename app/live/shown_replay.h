#pragma once

#include <filesystem>
#include <optional>

#include "app/recording/replay_session.h"
#include "app/windows/window_settings.h"

namespace planlight {

struct ShownReplaySettings {
    double speed = 1;                   ///< of the recorded clock
    double longest_pause_s = 1;         ///< of that clock, in which nothing was seen; of a longer one no more is shown
    bool close_at_end = false;          ///< else the window stays until it is closed
    std::filesystem::path screenshots;  ///< folder for a picture of the window a state; empty: none
    WindowSettings window;              ///< its language and its theme
};

/// A replay in the operator's window, at the pace at which it was recorded or as near to it as can be computed: the
/// same frames through the same code, compared bit for bit as by `replay_session`. Nothing is projected, and no press
/// does anything. Empty when the window was closed before the end. Throws as `replay_session`, and DeviceError without
/// a display.
std::optional<ReplayResult> show_replay(const std::filesystem::path& recording, const Case& the_case,
                                        const ShownReplaySettings& settings = {});

}  // namespace planlight
