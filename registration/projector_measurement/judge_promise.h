#pragma once

#include "registration/projector_measurement/measure_latency.h"

namespace planlight {

/// What the projector promised against `result.delays`, and the delay to set: `promise` and `light_delay_s`.
///
/// The delay to set counts from the return of `show` (from the order where that is not known). It covers the latest
/// light that was seen and the median with three times jitter and its own error, and a millisecond more, in whole
/// milliseconds.
void judge_promise(const LightRecording& recording, LatencyResult& result);

}  // namespace planlight
