#pragma once

#include <filesystem>
#include <optional>

#include "app/kept_match.h"
#include "app/recording/recording_time_line.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/stereo_frame.h"

namespace planlight {

/// A frame that was kept, with the picture that the projector was given after it, where that was kept.
struct RecordedMoment {
    double at_s = 0;  ///< since the room was entered
    StereoFrame frame;
    RgbImage light;  ///< empty: not kept
};

/// What a recording kept of single frames, each read from where it stands: of an hour as soon as of a minute. Frames
/// are named by their place in `RecordingTimeLine::frames_s`. All of it throws DamagedFileError for what does not read.
class RecordedMoments {
public:
    /// Keeps a reference to the time line, which is this recording's.
    RecordedMoments(const std::filesystem::path& recording, const RecordingTimeLine& line)
        : reader_(recording), line_(line) {}

    RecordedMoment moment(std::size_t frame);
    /// T_cur at that frame, as the session followed it; empty: it did not, or lost it.
    std::optional<RigidTransform> rig_from_patient(std::size_t frame);
    /// The last match before it; empty: none was kept.
    std::optional<KeptMatch> match(std::size_t frame);

    const RecordingTimeLine& line() const { return line_; }

private:
    RecordingChunk chunk(std::uint64_t place);

    RecordingReader reader_;
    const RecordingTimeLine& line_;
};

/// Both cameras and, where there is one, the projector's picture beside each other, as high as the cameras' are.
RgbImage picture_of(const RecordedMoment& moment);

}  // namespace planlight
