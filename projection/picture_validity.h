#pragma once

#include "planning_io/types/time.h"

namespace planlight {

/// How long a picture may stay where no other follows. Where pictures come twenty times a second or more, the next one
/// is there long before, and what a display takes until its darkness is seen is left out: then light is hardly
/// ever older than `longest` (8 ms at the worst of 100 on a monitor by software OpenGL: `watch_running_light`).
/// `usual_life`: from one picture to the next; 0: not known.
inline Instant picture_validity(Instant longest, Instant usual_life) {
    constexpr Instant kOften = std::chrono::milliseconds(50), kTimeToDark = std::chrono::milliseconds(10);
    return usual_life > Instant{} && usual_life <= kOften ? longest - kTimeToDark : longest;
}

}  // namespace planlight
