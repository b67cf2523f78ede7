#pragma once

#include <array>

#include "planning_io/types/image.h"

namespace planlight {

/// The part of a picture that sharpness is measured in: its middle, half as wide and half as high. What stands behind
/// the patient, at another distance, lies round it. x, y, width, height.
std::array<int, 4> focus_region(const GrayImage& picture);

/// How sharp the middle of a picture is, for finding the best focus of one scene: the higher the sharper; what it is
/// worth by itself depends on what is seen.
///
/// The root mean square of the grey values' gradient (Tenengrad: Tenenbaum 1970, Krotkov 1987, here of a picture
/// smoothed by a Gaussian of one pixel), without what the sensor's noise adds (its size by Immerkaer 1996, as the
/// median over the pixels), over the mean grey: per cent a pixel. Gradient and mean grow alike with the exposure, so
/// that it cancels. Saturated pixels and their neighbours do not count. 0 where nothing is seen.
double focus_measure(const GrayImage& picture);

}  // namespace planlight
