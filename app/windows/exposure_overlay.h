#pragma once

#include "planning_io/types/image.h"

namespace planlight {

/// What stands for them in the picture, and beside their shares.
inline constexpr Rgb kTooBright_colour{235, 40, 40}, kTooDark_colour{0, 90, 235};

/// A camera's picture as it was exposed, not brightened, with every `by` x `by` pixels as one: red stripes (zebra)
/// where one of them is too bright to be measured, blue where all are too dark.
RgbImage exposure_overlay(const GrayImage& picture, int by);

}  // namespace planlight
