#pragma once

#include <optional>
#include <vector>

#include "projection/check_light.h"

namespace planlight {

/// How far along `sideways_in_ct` a device at `centre_in_ct` goes per millimetre that its ray gains on the skin's
/// normal: what stands h above the skin is seen at -h times this.
double sideways_slope(const SeenSegment& segment, const Eigen::Vector3d& centre_in_ct);

/// Light that both cameras see at other places lies above or below the skin.
struct SeenDepth {
    double apart_mm = 0;  ///< left less right, along `sideways_in_ct`
    double slopes = 0;    ///< right less left
    double sigma_mm = 0;  ///< of `apart_mm`
};
struct LightDepth {
    double mm = 0, sigma_mm = 0;  ///< along the normal, positive outwards
};

/// The one depth that several stretches speak for: least squares with Huber weights, for a camera may take a gloss for
/// the light. Empty where they tell it no better than 0.25 mm.
std::optional<LightDepth> fit_depth(const std::vector<SeenDepth>& seen);

}  // namespace planlight
