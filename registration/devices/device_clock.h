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
    /// Where the camera's own times come evenly it is told at once: a clock that was set stumbles, and one that does
    /// not is that of a camera that is behind, for as long as that lasts.
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
    Instant last_jump() const { return last_jump_; }  ///< how far the last jump went; positive: ahead
    /// How much later than they should the last frames come, three at least; 0: in time.
    Instant behind() const { return late_in_a_row_ >= 3 ? least_late_ : Instant{}; }
    /// Seconds a second by which the device's clock runs fast, where that is more than any clock may; 0: it is well, or
    /// not known yet.
    double runs_wrong() const { return runs_wrong_; }
    Instant span() const;  ///< by the device, that the fit rests on
    std::size_t size() const { return frames_.size(); }

private:
    struct Frame {
        Instant by_device, late;  ///< arrived - by_device
    };
    void fit();
    void judge_run(Instant by_device, Instant arrived);
    bool was_set(Instant by_device, Instant off);
    void begin_anew(Instant off);
    bool steps_evenly(Instant by_device);
    bool lateness_grows(Instant by_device, Instant off);

    DeviceClockSettings settings_;
    std::deque<Frame> frames_;
    std::deque<Frame> recent_;  ///< of the last seconds, those that came late as well
    Instant origin_{}, offset_{}, sigma_{};
    double drift_ = 0;
    std::size_t jumps_ = 0;
    Instant late_since_{-1};  ///< by the device, first of the late frames in a row; -1: the last was not late
    int late_in_a_row_ = 0;
    Instant least_late_{};
    bool behind_ = false;  ///< it came late all at once, and its own times ran on evenly
    Instant block_since_{}, block_least_{}, last_block_least_{};
    int growing_blocks_ = 0;
    Instant last_jump_{}, last_off_{};
    double runs_wrong_ = 0;
    Instant last_by_device_{-1}, usual_step_{};
    int even_steps_ = 0;  ///< in a row, that were a whole number of the usual one
};

}  // namespace planlight
