#pragma once

#include "planning_io/types/image.h"

namespace planlight {

/// Whether a picture is a colour camera's raw mosaic (Bayer 1976) taken for grey: in each square of two by two pixels
/// one diagonal (green) is alike and differs from the others by over 15 %, and it is the same diagonal nearly
/// everywhere where there is light. Interlaced lines, columns of unlike gain, noise and texture do not do that.
bool is_colour_mosaic(const GrayImage& picture);

inline constexpr const char* kColourMosaicRemedy =
    "Set the camera's pixel format to Mono8, or convert the pictures to grey before they are given.";

/// Throws CheckFailedError where the picture of that camera ("left") is one.
void refuse_colour_mosaic(const GrayImage& picture, const char* camera);

}  // namespace planlight
