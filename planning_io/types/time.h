#pragma once

#include <chrono>

namespace planlight {

/// A moment on the one monotonic clock of a session (its epoch is arbitrary). Never wall-clock time.
using Instant = std::chrono::nanoseconds;

/// As a number, for arithmetic; exact to 1 ns up to three months.
inline double seconds(Instant t) {
    return std::chrono::duration<double>(t).count();
}

/// Cut to whole nanoseconds.
inline Instant from_seconds(double s) {
    return std::chrono::duration_cast<Instant>(std::chrono::duration<double>(s));
}

/// The injected clock: real, simulated or replayed.
class Clock {
public:
    virtual ~Clock() = default;
    virtual Instant now() const = 0;
};

}  // namespace planlight
