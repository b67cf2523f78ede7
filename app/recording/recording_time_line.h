#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/recording/session_recorder.h"
#include "app/windows/time_line.h"

namespace planlight {

/// The time line of a recording, and where its frames stand in the file.
struct RecordingTimeLine : TimeLine {
    RecordingHead head;
    std::string room_entered_utc;  ///< when the time line begins, by the clock on the wall; empty: not told
    /// Of a kept frame and what belongs to it (`RecordingReader::chunk_at`); 0: there is none.
    struct Places {
        std::uint64_t frame = 0;
        std::uint64_t light = 0;    ///< what the projector was given after it
        std::uint64_t updated = 0;  ///< what the session made of it
        std::uint64_t match = 0;    ///< the last one before it
        std::size_t lit = 0;        ///< of `lit`: under which light it was taken
    };
    /// Whether there was light, and what a person has asked of it since the last match, in order: a call and its item
    /// or landmark, -1 for the plan.
    struct Lit {
        bool light = false;
        std::vector<std::pair<std::string, int>> asked;
        bool operator==(const Lit&) const = default;
    };
    std::vector<Lit> lit{{}};
    std::vector<Places> places;  ///< one of each of `frames_s`
    std::string ended;           ///< how it ends, in words; empty: it is whole
    bool damaged = false;
    bool damaged_pictures = false;  ///< what happened is whole, and its pictures are not (`look_at_pictures`)
};

/// Reads every byte of a recording, for `time_line_of` passes the pictures over: an hour in some seconds. Says in
/// `ended` what is damaged among them. Nothing where the line itself is damaged.
void look_at_pictures(RecordingTimeLine& line, const std::filesystem::path& recording);

/// Reads a recording through, its pictures passed over: an hour in some seconds. Throws InputError, DamagedFileError.
RecordingTimeLine time_line_of(const std::filesystem::path& recording);

}  // namespace planlight
