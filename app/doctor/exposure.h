#pragma once

#include <optional>

#include "planning_io/types/image.h"
#include "registration/scan/scan_surface.h"

namespace planlight {

/// How the projector's light suits a camera, by its picture under white and under black.
struct Exposure {
    double saturated_share = 0;     ///< of what is lit
    double lit_share = 0;           ///< of the picture
    double brightest_lit_grey = 0;  ///< 95 % of what is lit is darker
};

Exposure exposure_of(const GrayImage& white, const GrayImage& black);

/// How much of the light's contrast the fringes of a scan keep in one camera: their modulation over that of white and
/// black, median over what is well lit and not saturated. Empty: no fringes, or nothing lit. `frames` are in the order
/// of `stripe_sequence(stripes)`.
std::optional<double> fringe_share(const std::vector<GrayImage>& frames, const StripeSettings& stripes);

}  // namespace planlight
