#pragma once

#include <deque>
#include <optional>
#include <string>

#include "app/recording/recorded_inputs.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/stereo_frame.h"

namespace planlight {

/// Why a replay cannot go on: the recording ends there, or lacks something.
struct ReplayEnds {
    std::string why;  ///< empty: it is simply over
};

/// The way through a recording that a replay takes: what the devices answered and what came of it, in order. Frames are
/// unpacked when they are asked for.
class RecordingCursor {
public:
    explicit RecordingCursor(const std::filesystem::path& file) : reader_(file) {}

    /// One line of JSON of a session's event, or an answer of a device, whichever stands next.
    struct Next {
        std::optional<std::string> event;
        std::optional<RecordedInput> input;
    };
    /// Passes over presses and words of the banner, which go nowhere. Throws ReplayEnds.
    const Next& peek();
    Next take();
    /// The pictures of a frame that was taken just now. Throws ReplayEnds when they were not kept.
    StereoFrame frame(const RecordedInput& input);

    const RecordingReader& reader() const { return reader_; }
    const std::optional<RecordingChunk>& room() const { return room_; }
    const std::optional<RecordingChunk>& head() const { return head_; }
    /// The last match that was kept; empty before the first.
    const std::optional<RecordingChunk>& match() const { return match_; }
    /// Reads on to the first event or answer; head and room are there afterwards, if the recording has them.
    void begin();
    Instant at() const { return at_; }  ///< of the last chunk

private:
    bool read_chunk();

    RecordingReader reader_;
    std::deque<Next> next_;
    std::deque<RecordingChunk> frames_;  ///< the last ones
    std::optional<RecordingChunk> head_, room_, match_;
    std::string lost_;  ///< what was dropped where the reader stands
    Instant at_{};
};

}  // namespace planlight
