#pragma once

#include <optional>

#include "registration/scan/check/check_sequence.h"
#include "registration/scan/decode/decode_stripes.h"

namespace planlight {

/// Whether the code ends where the projector's picture does. Fringes of another period than capture.json says are read
/// without a contradiction, with every place off by the ratio of the two: only the picture's end tells. Where the light
/// ends on what the room lights on, in a straight edge at one column or row, that is the last one (to 5 %, for some
/// projectors show the middle of their picture only); and no light is seen beyond the code's last one.
///
/// Of the first such direction, with cause `fringes`; empty: nothing is wrong, or no end is in sight. `white` and
/// `black` are the view's pictures.
std::optional<SequenceProblem> check_panel_ends(const DecodedView& view, const GrayImage& white, const GrayImage& black,
                                                const StripeSettings& stripes);

}  // namespace planlight
