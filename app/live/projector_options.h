#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace planlight {

/// What `planlight projector` was asked for.
struct ProjectorOptions {
    std::filesystem::path recording, keep, out,
        pdf;                         ///< `out`: projector.json, empty: not written; `keep`: folder for what is recorded
    std::filesystem::path room;      ///< room.json whose projector and cameras are measured; empty: none
    std::string simulate;            ///< preset of the simulated room; empty: none
    std::vector<std::string> light;  ///< of the simulated room, NAME=NUMBER
    std::string part = "all", monitor, serial;
    unsigned seed = 1;
    double refresh_hz = 60, refresh_tolerance_hz = 0.1;
    double configured_delay_ms = -1;  ///< the delay in force; below 0: as the recording says
    bool identify = false, show = false;
    double frames_hz = 25;  ///< of the cameras that look while `show`s
    double seconds = 15;    ///< of `identify`
    bool json = false;
};

}  // namespace planlight
