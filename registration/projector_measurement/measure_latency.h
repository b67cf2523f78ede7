#pragma once

#include <optional>
#include <string>
#include <vector>

#include "registration/projector_measurement/light_recording.h"

namespace planlight {

/// One change of light: from the order to the light that the cameras saw, seconds.
struct LightDelay {
    std::size_t order = 0;                 ///< index into the recording's orders
    double at_least_s = 0, at_most_s = 0;  ///< equal where the change is known to a moment
    bool exact = false;                    ///< it did, or it came at a refresh that others showed
};

/// Of the measurement of the delay from order to light.
struct LatencySettings {
    double least_s = -0.3, most_s = 1.5;  ///< searched
    double refresh_hz = 60;  ///< of the projector, within 1 %: its changes may come then only; what is a picture late
};

/// From order to light as the cameras see it.
struct LatencyResult {
    std::optional<LightRefusal> refusal;
    double median_s = 0;        ///< of a normal distribution fitted to all changes, their bounds taken as bounds
    double median_sigma_s = 0;  ///< one standard deviation of `median_s`; never under what the exposures resolve
    double jitter_s = 0;        ///< standard deviation from change to change
    double jitter_sigma_s = 0;
    double earliest_s = 0, latest_s = 0;  ///< what some change surely was at most, at least
    std::vector<LightDelay> delays;       ///< one a change that was seen
    std::size_t changes = 0;              ///< ordered
    std::size_t exact = 0;                ///< seen within an exposure
    double refresh_hz = 0;                ///< at which the changes were seen to come; 0: not seen
    std::size_t unseen = 0;               ///< orders of which no light was ever seen: the projector left a picture out
    double blind_s = 0;                   ///< light that changes between exposures only: the time between them; else 0
    std::size_t late = 0;                 ///< later than the median by more than three quarters of a picture's time
    double code_agreement = 0;            ///< correlation of what was seen with the code at that delay, 1 = all of it
    double runner_up_agreement = 0;       ///< the best at any delay that is off by more than half the shortest flash
    FrameTiming frames;
    /// Of the orders that promised a moment: the promised delay (median), how many were light only after that moment,
    /// and by how much the worst. Empty: none promised one.
    struct Promise {
        double delay_s = 0;
        std::size_t orders = 0, broken = 0;
        double too_early_s = 0;
    };
    std::optional<Promise> promise;
    double light_delay_s =
        0;  ///< what to set as delay from the return of `show` so that the light is there: covers the latest
};

/// The delay at which the ordered flashes fit the frames, then every change by itself.
///
/// Needs black and white flashes, each at least two frames long, each light a third of the time or more. A frame counts
/// the share of its exposure that the new light was there. Refused: nothing seen, saturated, flashes shorter than the
/// frames tell apart, a sequence that repeats within the search, a code that does not fit, light before its order.
LatencyResult measure_latency(const LightRecording& recording, const LatencySettings& settings = {});

}  // namespace planlight
