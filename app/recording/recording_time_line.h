#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/recording/session_recorder.h"
#include "app/windows/time_line.h"

namespace planlight {

/// The time line of a recording, and where its frames stand in the file.
struct RecordingTimeLine : TimeLine {
    RecordingHead head;
    /// Of a kept frame and what belongs to it (`RecordingReader::chunk_at`); 0: there is none.
    struct Places {
        std::uint64_t frame = 0;
        std::uint64_t light = 0;    ///< what the projector was given after it
        std::uint64_t updated = 0;  ///< what the session made of it
        std::uint64_t match = 0;    ///< the last one before it
    };
    std::vector<Places> places;  ///< one of each of `frames_s`
    std::string ended;           ///< how it ends, in words; empty: it is whole
    bool damaged = false;
};

/// Reads a recording through, its pictures passed over: an hour in some seconds. Throws InputError, DamagedFileError.
RecordingTimeLine time_line_of(const std::filesystem::path& recording);

}  // namespace planlight
