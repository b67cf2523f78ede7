#pragma once

#include <cstddef>

#include "planning_io/types/image.h"

namespace planlight {

/// The colour of a point's distance to the skin: teal at 0, green, yellow, orange, red at `largest_mm` and beyond; grey
/// when it is not finite. The sign does not matter.
Rgb distance_colour(double distance_mm, double largest_mm);

/// Green up to `warn_mm`, amber up to `stop_mm`, red above; grey when it is not finite.
Rgb error_colour(double error_mm, double warn_mm, double stop_mm);

/// Of the n-th risk structure: none is a colour of the plan, of a distance, or of skin. They begin again after six.
Rgb risk_colour(std::size_t n);

}  // namespace planlight
