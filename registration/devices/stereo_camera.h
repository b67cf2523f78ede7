#pragma once

#include <chrono>
#include <cstdint>

#include "planning_io/types/image.h"
#include "planning_io/types/time.h"

namespace planlight {

/// What both cameras saw in one exposure.
struct StereoFrame {
    GrayImage left, right;
    Instant at{};              ///< mid-exposure, on the session's clock
    Instant exposure{};        ///< how long the shutter was open
    std::uint64_t number = 0;  ///< counts up by one per exposure; a jump is a lost frame
};

/// Two cameras that expose together.
class StereoCamera {
public:
    virtual ~StereoCamera() = default;

    /// The first frame whose exposure begins at or after `not_before`. Throws DeviceError after `patience` without one.
    virtual StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) = 0;
};

}  // namespace planlight
