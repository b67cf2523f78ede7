#pragma once

#include "planning_io/types/time.h"

namespace planlight {

/// The wall's monotonic clock (CLOCK_MONOTONIC), for what a person sees.
class SteadyClock final : public Clock {
public:
    Instant now() const override { return std::chrono::steady_clock::now().time_since_epoch(); }
};

}  // namespace planlight
