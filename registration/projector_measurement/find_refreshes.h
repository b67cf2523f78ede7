#pragma once

#include <optional>
#include <vector>

#include "registration/projector_measurement/measure_latency.h"

namespace planlight {

/// The moments at which a projector changes its picture: `first_s` + n / `hz`, on the recording's clock.
struct Refreshes {
    double first_s = 0, hz = 0;
    double tolerance_s = 0;  ///< how far a change that was seen may be off
};

/// From the changes that were seen within an exposure; `at_s`: when each of `delays` was ordered, `reading_s`: how well
/// such a change is read. Empty: fewer than 8 of them, or one in ten lies on no refresh within 1 % of `nominal_hz`.
///
/// The frequency with the longest mean vector of phases (Rayleigh's test; Mardia & Jupp, Directional Statistics, 6.3).
std::optional<Refreshes> find_refreshes(const std::vector<LightDelay>& delays, const std::vector<double>& at_s,
                                        double nominal_hz, double reading_s);

/// Changes between two exposures came at a refresh too. Where several may be it, it is the one that fits the delay that
/// most changes have in common before they wait for their refresh.
/// Empty: more than one in ten has no refresh between its exposures, so that they are none.
std::optional<std::vector<LightDelay>> at_refreshes(const Refreshes& refreshes, std::vector<LightDelay> delays,
                                                    const std::vector<double>& at_s);

}  // namespace planlight
