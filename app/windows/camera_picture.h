#pragma once

#include "planning_io/types/image.h"

namespace planlight {

/// The picture with every `by` x `by` pixels as one, their mean; what is left over at the right and lower edge is cut
/// off.
GrayImage shrunk(const GrayImage& picture, int by);

/// The picture as a person wants to see it: what is brighter than all but the brightest half per cent becomes white; at
/// most 16 times brighter, so that noise alone stays dark.
GrayImage brightened(GrayImage picture);

/// Grey as a picture in colours.
RgbImage rgb_of(const GrayImage& picture);

}  // namespace planlight
