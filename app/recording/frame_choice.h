#pragma once

#include <deque>
#include <vector>

#include "planning_io/types/time.h"

namespace planlight {

/// Which frames `--record events` keeps.
struct FrameChoiceSettings {
    double bytes_per_s = 260e3;                     ///< of the recording, in the long run: 0.94 GB an hour
    double bytes_ahead = 50e6;                      ///< that may be used up at once, and come back at that rate
    Instant usual_every = std::chrono::seconds(2);  ///< a frame, while nothing happens and half of that is left
    std::size_t before = 12, after = 12;            ///< frames round an event
};

/// Chooses frames within what a recording's budget of bytes leaves them: all else is kept as it comes, and paid first.
/// Time is handed in; knows frames by their order only.
class FrameChoice {
public:
    explicit FrameChoice(const FrameChoiceSettings& settings = {}) : settings_(settings), left_(settings.bytes_ahead) {}

    /// One frame more, of about so many bytes on the disk: whether it is kept now.
    bool keep(Instant at, double bytes);
    /// Something happened: whether the frames before (as many as `before`, of `bytes` each) and the next ones are kept.
    /// Gives how many of the ones before there is room for, the newest first.
    std::size_t event(std::size_t waiting, double bytes);
    /// So much was written of what is no frame, or of a frame that nobody was asked for.
    void written(double bytes) { left_ -= bytes; }

private:
    bool pay(double bytes);
    FrameChoiceSettings settings_;
    double left_;
    Instant last_{-1}, usual_{-1};  ///< -1: none yet
    std::size_t after_ = 0;
};

}  // namespace planlight
