#pragma once

#include <span>

#include "planning_io/types/image.h"
#include "registration/scan/decode/decode_stripes.h"

namespace planlight {

/// The frames of a Gray code without fringes: per bit, coarsest first, the picture and its inverse.
struct GrayPairs {
    const GrayImage &white, &black;
    std::span<const GrayImage> columns, rows;
    int projector_width = 0, projector_height = 0;
};

/// When a bit is believed: its difference to its inverse is at least this, in grey and by (white - black).
struct GrayLimits {
    int least_grey = 5;
    double least_share = 0.15;
    int saturated_at = 254;
};

/// Decodes to whole projector pixels, or between two of them where just the bit of their common border is in doubt; NaN
/// where any other bit is. `sigma_px` is 0.29, that of an even spread over one pixel. Throws std::invalid_argument when
/// the frames differ in size or a code has more than 16 bits.
DecodedView decode_gray_pairs(const GrayPairs& frames, const GrayLimits& limits = {});

}  // namespace planlight
