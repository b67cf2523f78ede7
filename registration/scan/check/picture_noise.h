#pragma once

#include "planning_io/types/image.h"

namespace planlight {

/// The noise of one picture of a camera where there is light: one sigma, grey. From how much more white than black
/// differs between a pixel and the next where white is brighter by 16 grey: of skin hardly (its texture is in both), of
/// noise by twice its sigma. The median, so that edges do not count, and that it holds as well when white or black is
/// another picture of the sequence. 0 where nothing is lit.
double noise_in_light(const GrayImage& white, const GrayImage& black);

/// The same where there is no light: from the places where white is darker than black, as every other unlit one is. In
/// a camera that encodes its pictures for a screen it is 10 grey and more, and looks like light. 0 where all is lit. It
/// says nothing when white or black is another picture.
double noise_in_dark(const GrayImage& white, const GrayImage& black);

}  // namespace planlight
