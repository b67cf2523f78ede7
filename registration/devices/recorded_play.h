#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "planning_io/types/time.h"
#include "registration/devices/recorded_light.h"

namespace planlight {

/// A frame of a recording: when it was exposed, by the recording's own clock, and what it shows.
struct RecordedFrame {
    Instant at{}, exposure{};  ///< mid-exposure; how long the shutter was open
    std::size_t picture = 0;   ///< which of the recorded pictures
    std::size_t lost = 0;      ///< frames that were lost between the one before and this
};

enum class RecordedPace {
    own,      ///< as it was recorded; it begins again when it is over
    fastest,  ///< the next frame as soon as the one before was taken: nobody waits, and none is left out
};

/// Both cameras of a recording being played: when they expose, and which picture each exposure shows. One for both, so
/// that they expose together. From any thread.
class RecordedPlay {
public:
    struct Exposure {
        std::uint64_t number = 0;  ///< from 1
        Instant at{}, exposure{};  ///< on the session's clock
        std::size_t picture = 0;
        std::size_t lost = 0;
    };

    /// `frames`: one at least, in the order of their times; the first is exposed from `began` on, on the session's
    /// clock. `light`: where it shows a picture of the recording, an exposure shows that in place of its own; may be
    /// null.
    RecordedPlay(std::vector<RecordedFrame> frames, RecordedPace pace, Instant began,
                 std::shared_ptr<const RecordedLight> light = {});

    /// The exposures after number `after` that a camera has by `now`: at its own pace those that are over, of which the
    /// newest `most`; at the fastest the next one, which begins now, or none while the other camera has not asked for
    /// the one before: a camera whose thread gets no processor for a while would else stay behind, and be in no pair
    /// again.
    std::vector<Exposure> due(std::uint64_t after, Instant now, std::size_t most);

    RecordedPace pace() const { return pace_; }
    /// From the first frame to that of the next round: what was recorded, and one frame interval.
    Instant round() const { return round_; }

private:
    Exposure exposure(std::uint64_t number, Instant at) const;
    Instant at_own_pace(std::uint64_t number) const;
    std::optional<Exposure> next_at_once(std::uint64_t after, Instant now);

    std::vector<RecordedFrame> frames_;
    RecordedPace pace_;
    Instant began_, round_;
    std::shared_ptr<const RecordedLight> light_;
    std::mutex mutex_;
    Exposure given_;    ///< at the fastest pace: the last one, for the camera that asks second; number 0: none yet
    int given_to_ = 0;  ///< how many cameras have it
};

}  // namespace planlight
