#pragma once

#include "planning_io/types/image.h"

namespace planlight::test {

/// A picture in which no pixel equals a neighbour and no row, column or mirror image equals another: a shift by one
/// pixel, a flip or any smoothing is seen. Nothing in it is black.
RgbImage projector_picture(int width, int height);

}  // namespace planlight::test
