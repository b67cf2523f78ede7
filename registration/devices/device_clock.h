#pragma once

#include <cstddef>
#include <deque>

#include "planning_io/types/time.h"

namespace planlight {

/// How a device's clock is laid on the session's.
struct DeviceClockSettings {
    Instant window = std::chrono::seconds(60);             ///< of frames that the fit rests on
    Instant drift_known_after = std::chrono::seconds(4);   ///< before, both clocks are taken to run alike
    double largest_drift = 500e-6;                         ///< seconds a second; more is another clock than was thought
    Instant largest_jump = std::chrono::milliseconds(20);  ///< of arrivals off the fit; more is a clock that was set
    /// Frames that come late for so long do not come late: the clock was set. Until then they count as late, for a
    /// computer that is busy for a moment is no clock that was set, and to take it for one would make old pictures new.
    Instant late_for = std::chrono::seconds(2);
};

/// The running fit of a device's clock to the session's: offset and drift, from the device's times of frames and the
/// moments at which they arrived. A frame arrives late, never early, so the line lies under the arrivals (the lower
/// envelope of Moon, Skelly & Towsley 1999), and what delays the quickest frame is the caller's to know.
class DeviceClock {
public:
    explicit DeviceClock(const DeviceClockSettings& settings = {});

    /// A frame's time by the device, and its arrival by the session's clock. False when the device's clock jumped: what
    /// was known is forgotten, and the fit begins anew with this frame.
    bool add(Instant by_device, Instant arrived);

    /// A device's moment on the session's clock, as if the quickest frame took no time. The clock must have a frame.
    Instant on_session_clock(Instant by_device) const;

    bool known() const { return !frames_.empty(); }
    double drift() const { return drift_; }         ///< seconds a second; positive: the device runs slow
    Instant uncertainty() const { return sigma_; }  ///< one standard deviation of `on_session_clock`, now
    std::size_t jumps() const { return jumps_; }

private:
    struct Frame {
        Instant by_device, late;  ///< arrived - by_device
    };
    void fit();

    DeviceClockSettings settings_;
    std::deque<Frame> frames_;
    Instant origin_{}, offset_{}, sigma_{};
    double drift_ = 0;
    std::size_t jumps_ = 0;
    Instant late_since_{-1};  ///< by the device, first of the late frames in a row; -1: the last was not late
};

}  // namespace planlight
