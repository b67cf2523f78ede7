#pragma once

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

}  // namespace planlight
