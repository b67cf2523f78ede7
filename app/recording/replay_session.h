#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "app/recording/session_recorder.h"
#include "planning_io/recording/recording_reader.h"

namespace planlight {

/// Where a replay first came to something else than the recording.
struct ReplayDifference {
    std::uint64_t frame = 0;  ///< number of the last frame that the session had taken
    Instant at{};             ///< of that frame, on the session's clock
    int update = 0;           ///< counts from 1; 0: before the first
    std::string what;         ///< in words: what differs, as recorded and as now
};

struct ReplayResult {
    RecordingHead head;
    int scans = 0, matches = 0, updates = 0, rulings = 0, skin_checks = 0, resumptions = 0,
        refusals = 0;  ///< alike to the last digit
    int compared() const { return scans + matches + updates + rulings + skin_checks + resumptions + refusals; }
    int pictures = 0, frames = 0;
    std::optional<ReplayDifference> difference;
    std::string ended;  ///< why before the recording's own end, in words; empty: it was replayed to its end
    RecordingEnd end = RecordingEnd::open;
    bool other_program = false;  ///< it was recorded by another build of the program
    Instant began{};             ///< of the first frame, on the session's clock
    double recorded_s = 0;       ///< from the first to the last moment that was replayed, on the session's clock
};

/// Gives the recorded frames, with the recorded clock, to the same code again, as fast as it can be computed, and
/// compares each scan, match, pose, picture, measurement and decision with what was recorded, bit for bit. Stops at the
/// first difference.
///
/// `the_case`: that of the recording. Throws InputError when it is another, or when the recording does not hold every
/// frame (`--record all`); DamagedFileError.
///
/// `watcher` (null: nobody) is told of all that the session does, as its observers were when it was recorded; presses
/// and the banner's words were not the session's, and are not told. What `progress` throws ends the replay.
ReplayResult replay_session(const std::filesystem::path& recording, const Case& the_case,
                            const std::function<void(double)>& progress = {}, SessionObserver* watcher = nullptr);

/// What a recording says of itself, without replaying it. Throws InputError, DamagedFileError.
RecordingHead head_of_recording(const std::filesystem::path& recording);

}  // namespace planlight
