#pragma once

#include "projection/check_light.h"

namespace planlight {

/// Side by side on one stroke, of which every `step`-th stretch is looked at.
bool side_by_side(const SeenSegment& a, const SeenSegment& b, std::size_t step, const CheckLightSettings& settings);

/// All figures of a look, from its `segments`; `items` with name, `lit`, `dim`, `lit_segments` and depth are there.
/// What is seen of dim items counts for themselves alone, and their segments are taken out.
void sum_up_light(std::size_t step, const CheckLightSettings& settings, LightCheck& check);

}  // namespace planlight
