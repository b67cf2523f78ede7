#pragma once

#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>

#include "planning_io/types/time.h"

namespace planlight {

/// Which picture of a recorded scan is lit: a recorded projector tells it, and recorded cameras ask. From any thread.
class RecordedLight {
public:
    /// From `from` to `until` it is that picture of the recording; empty: a light that was not recorded, or none.
    void shows(std::optional<std::size_t> picture, Instant from, Instant until);

    /// Which picture is lit at that moment; empty: none of the recording.
    std::optional<std::size_t> at(Instant moment) const;

private:
    struct Order {
        std::optional<std::size_t> picture;
        Instant from, until;
    };
    mutable std::mutex mutex_;
    std::deque<Order> orders_;  ///< the newest last; exposures of a moment ago are asked for as well
};

}  // namespace planlight
