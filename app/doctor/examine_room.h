#pragma once

#include <exception>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <vector>

#include "app/doctor/judge_room.h"
#include "planning_io/case/room_file.h"

namespace planlight {

/// Runs a question to the window system where such questions may be asked, and returns when it is answered.
using AskWindowSystem = std::function<void(const std::function<void()>&)>;

/// What is to be examined, and how long it may take.
struct ExamineSettings {
    std::filesystem::path case_folder;                  ///< empty: no case
    Instant watch = std::chrono::seconds(2);            ///< the cameras, before any light
    std::function<void(const std::string&)> under_way;  ///< each step as it begins; may be empty
    std::function<void(const DoctorLine&)> found;       ///< each line as it is found; may be empty
    std::stop_token ended = {};                         ///< then it stops, dark, with the lines so far
    AskWindowSystem ask_window_system;                  ///< empty: here, in the main thread
};

/// The whole room before a patient comes: devices opened, watched, lit and scanned with. Nobody may lie under the
/// projector. What cannot be examined because of something before is left out; what failed is a line of its own.
std::vector<DoctorLine> examine_room(const RoomFile& room, const ExamineSettings& settings);

/// What is said where something could not be examined for a reason that nobody foresaw.
DoctorLine line_of_failure(const std::string& subject, const std::exception& error);

/// Rate, loss, clocks and pairs of both cameras while their pairs are taken for so long.
struct WatchedCameras {
    CameraFigures left, right;
    PairFigures pairs;
};
class PairedCameras;
WatchedCameras watch_cameras(PairedCameras& cameras, const RoomFile& room, const Clock& clock, Instant how_long);

/// The projector's delay by a quick flash, and whether both cameras see it at one moment.
DelayFigures flash(Projector& projector, StereoCamera& cameras, const Clock& clock);

}  // namespace planlight
