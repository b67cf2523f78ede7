#pragma once

#include "registration/projector_measurement/measure_latency.h"

namespace planlight {

/// A normal distribution through `result.delays`: median, jitter, their standard deviations, the extremes.
///
/// Maximum likelihood with censored observations: a change between two exposures counts by the probability of its
/// bounds, one within an exposure by its density, widened by `noise` (share of white) times the exposure. Unbiased by
/// which changes happened to fall within an exposure.
void fit_delays(double noise, Instant exposure, LatencyResult& result);

}  // namespace planlight
