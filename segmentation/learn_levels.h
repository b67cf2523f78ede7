#pragma once

#include <vector>

#include "segmentation/head_outline.h"

namespace planlight {

/// Where air and tissue part in a histogram of values, on the root of the values above the least (noise and tissue
/// differ by factors, not by steps; Otsu 1979 on that scale). Not above the least value where there is but one.
double first_threshold(const std::vector<float>& measured);

/// Air and the skin's threshold, block by block of 20 mm, from what lies round (6 to 24 mm off) and in (to 6 mm deep)
/// the head that `outline.head` holds so far: writes `outline.levels`, `air`, `air_sigma` and `tissue`. `values`: the
/// survey's, smoothed. Returns the values of the map's nodes below which all is air.
std::vector<float> learn_levels(const HeadSurvey& survey, const std::vector<float>& values,
                                const OutlineSettings& settings, HeadOutline& outline);

}  // namespace planlight
