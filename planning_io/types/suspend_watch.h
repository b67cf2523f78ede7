#pragma once

#include <time.h>

#include <optional>

#include "planning_io/types/steady_clock.h"

namespace planlight {

/// Tells that the computer was asleep: `SteadyClock` stands still then, and what was promised by it looks as fresh as
/// before, though the patient may have been moved for an hour.
class SuspendWatch {
public:
    /// True once after each sleep of half a second or more between two looks. `boottime` is CLOCK_BOOTTIME, which goes
    /// on in sleep, read between the other two, which are of SteadyClock.
    bool look(Instant before, Instant boottime, Instant after) {
        constexpr Instant kLeast = std::chrono::milliseconds(500);
        const bool slept = most_ahead_ && boottime - after > *most_ahead_ + kLeast;
        most_ahead_ = boottime - before;
        return slept;
    }
    bool look() {
        const SteadyClock clock;
        const Instant before = clock.now();
        timespec boottime{};
        clock_gettime(CLOCK_BOOTTIME, &boottime);
        return look(before, std::chrono::seconds(boottime.tv_sec) + std::chrono::nanoseconds(boottime.tv_nsec),
                    clock.now());
    }

private:
    std::optional<Instant> most_ahead_;  ///< of the one clock before the other, at the most
};

}  // namespace planlight
