#pragma once

#include <chrono>
#include <string>

#include "planning_io/types/stereo_frame.h"

namespace planlight {

/// Two cameras that expose together.
class StereoCamera {
public:
    virtual ~StereoCamera() = default;

    /// The first frame whose exposure begins at or after `not_before`. Throws DeviceError after `patience` without one.
    virtual StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) = 0;

    /// The newest frame whose exposure begins at or after `not_before`, which may lie in the past; waits for one where
    /// there is none. Throws DeviceError after `patience` without one.
    virtual StereoFrame newest(Instant not_before, std::chrono::milliseconds patience) {
        return grab(not_before, patience);
    }

    /// Waits until the shutters of the frame that `grab(not_before)` will give have closed, which is before it has come
    /// from the cameras. False, at once: that cannot be told here, or no frame will come in `patience`; `grab` tells.
    virtual bool wait_until_exposed(Instant /*not_before*/, std::chrono::milliseconds /*patience*/) { return false; }

    /// What is wrong with the cameras now though frames come, in a sentence that names the camera; empty: nothing.
    virtual std::string doubt() const { return {}; }
};

}  // namespace planlight
