#pragma once

#include "planning_io/types/image.h"

namespace planlight {

/// From here on a pixel of 8 bits is too bright: its light is more than the sensor could count, and cannot be measured.
inline constexpr int kTooBright_grey = 254;
/// Below, stripes are lost in the noise.
inline constexpr int kTooDark_grey = 10;

/// How much of a picture cannot be measured, 0 to 1.
struct ClippedShares {
    double too_bright = 0, too_dark = 0;
};

ClippedShares clipped_shares(const GrayImage& picture);

}  // namespace planlight
