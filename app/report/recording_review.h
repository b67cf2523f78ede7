#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/recording/session_recorder.h"
#include "planning_io/types/stereo_frame.h"

namespace planlight {

/// A recording over its time, in seconds since the room was entered, without its pictures.
struct RecordingTimeLine {
    RecordingHead head;
    double lasted_s = 0;
    /// What the gate ruled over a stretch of time, at most `kLongest_s` long: its colour at the beginning, the worst of
    /// the rest.
    struct Stretch {
        double from_s = 0, to_s = 0;
        LightTrust trust = LightTrust::dark;
        double off_mm = -1;        ///< of the light, as the cameras measured it (95 %); -1: not measured
        double predicted_mm = -1;  ///< 95 % bound of the worst item, by match and pose; -1: not known
    };
    static constexpr double kLongest_s = 0.5;
    std::vector<Stretch> stretches;  ///< while the plan is followed; in between it is dark
    struct Event {
        double at_s = 0;
        std::string what;
    };
    std::vector<Event> events;
    std::vector<double> frames_s;  ///< of the frames that were kept
    std::string ended;             ///< how it ends, in words; empty: it is whole
    bool damaged = false;
};

/// Reads a recording through, its pictures passed over: an hour in some seconds. Throws InputError, DamagedFileError.
RecordingTimeLine time_line_of(const std::filesystem::path& recording);

/// A frame that was kept, with the picture that the projector was given after it, where that was kept.
struct RecordedMoment {
    double at_s = 0;
    StereoFrame frame;
    RgbImage light;  ///< empty: not kept
};

/// Calls `take` with every frame that was kept from one time to another, in order; gives how many there were.
int for_each_moment(const std::filesystem::path& recording, double from_s, double to_s,
                    const std::function<void(const RecordedMoment&)>& take);

/// Both cameras and, where there is one, the projector's picture beside each other, as high as the cameras' are.
RgbImage picture_of(const RecordedMoment& moment);

/// The page: time line in the gate's colours, measured and predicted error, events. `pictures`: files beside it that it
/// shows, with their captions; `more`: what stands behind them, as HTML.
std::string review_page(const RecordingTimeLine& line, const std::vector<std::pair<std::string, std::string>>& pictures,
                        const std::string& more = {});

/// The same as figures (JSON, `format` says `kReviewFormat`).
inline constexpr const char* kReviewFormat = "planlight review";
std::string review_json(const RecordingTimeLine& line);

}  // namespace planlight
