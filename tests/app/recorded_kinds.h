#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "planning_io/recording/recording_chunk.h"
#include "tests/app/played_session.h"

namespace planlight::test {

/// A kind of session that is recorded with every frame and replayed: of another room and with another fault than each
/// of the others.
struct RecordedKind {
    std::string name;  ///< in words
    PlayedSession how;
    /// What its events must hold, by a part of each: what never happened is replayed by anything.
    std::vector<std::string> must_hold;
    bool resumed = false;  ///< the match of a session before it in the same room is gone on with
    /// Only in the long tests.
    bool is_long = false;
};
inline void PrintTo(const RecordedKind& kind, std::ostream* out) {
    *out << kind.name;
}

/// Twenty of them; each can be played in any other room by another seed.
const std::vector<RecordedKind>& recorded_kinds();

/// Plays and records one into `file` (`--record all`); what goes before it is recorded beside. `beside` (null: nobody)
/// is told of it as well.
PlayedResult record_kind(const RecordedKind& kind, const ExampleCase& patient, const std::filesystem::path& file,
                         SessionObserver* beside = nullptr);

/// All that can be read of it, and back into a file.
std::vector<RecordingChunk> chunks_of(const std::filesystem::path& recording);
void write_recording(const std::vector<RecordingChunk>& chunks, const std::filesystem::path& file);

/// The part of `must_hold` that no event holds; empty: all are there.
std::string missing_of(const std::vector<RecordingChunk>& chunks, const std::vector<std::string>& must_hold);

/// Where a recording was changed by the last bit of one number, or by one letter.
struct Tampered {
    int update = 0;                      ///< that differs then; the one before where none is changed
    std::optional<std::uint64_t> frame;  ///< its number, where a pose was changed
    std::string what;                    ///< a part of how the difference must be named
};
/// Changes the pose in the middle of those that are known; where there is none, the match; where there is none, why
/// it was refused. Empty: it has none of them.
std::optional<Tampered> tamper(std::vector<RecordingChunk>& chunks);

}  // namespace planlight::test
