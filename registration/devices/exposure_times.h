#pragma once

#include <deque>
#include <optional>

#include "registration/devices/camera.h"

namespace planlight {

/// When a camera that runs by itself exposes, from its last frames: what comes next is known before it has come.
class ExposureTimes {
public:
    void add(const CameraFrame& frame);

    /// An exposure that is still to come, or has been.
    struct Expected {
        Instant at;        ///< mid-exposure
        Instant exposure;  ///< how long the shutter is open
        Instant closed;    ///< by then it has surely closed
    };

    /// The first exposure that surely begins at or after `not_before`, as far as the camera's clock is known. Empty:
    /// too few frames yet, they do not come evenly, or `not_before` is more than a second after the last of them.
    std::optional<Expected> first_after(Instant not_before) const;

private:
    struct Frame {
        Instant at, exposure, sigma;
    };
    std::deque<Frame> frames_;  ///< the newest last
};

}  // namespace planlight
