#pragma once

#include <span>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "registration/scan/decode/decode_stripes.h"
#include "registration/scan/pattern/stripe_patterns.h"

namespace planlight {

/// The pictures of a Gray code without fringes, down to single projector pixels (captures of others): white, black,
/// then columns and (`rows`) rows, coarsest bit first, each followed by its inverse (`inverse`); named as in
/// `stripe_sequence`. Of `stripes` those four, and where the code begins, are looked at.
std::vector<StripePattern> gray_code_patterns(const StripeSettings& stripes);

/// Decodes such frames to whole projector pixels, or between two of them where just the bit of their common border
/// differs from its inverse by less than 5 grey or 15 % of (white - black); NaN where any other bit does. Throws
/// std::invalid_argument when number or sizes do not fit.
DecodedView decode_gray_code(std::span<const GrayImage> frames, int projector_width, int projector_height);

/// The same of a code that begins where `stripes` says.
DecodedView decode_gray_code(std::span<const GrayImage> frames, const StripeSettings& stripes);

}  // namespace planlight
