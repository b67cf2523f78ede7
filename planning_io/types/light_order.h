#pragma once

#include <optional>

#include "planning_io/types/image.h"
#include "planning_io/types/time.h"

namespace planlight {

/// One order to the projector: its whole picture in one colour.
struct LightOrder {
    Instant at{};                     ///< when it was given
    std::optional<Instant> returned;  ///< when `Projector::show` came back; empty: not known
    std::optional<Instant> promised;  ///< the moment from which the projector said that it is light; empty: not said
    Rgb colour{0, 0, 0};
    bool covered = false;  ///< a lid was before the lens: not even the leak of a black picture came out
};

}  // namespace planlight
