#pragma once

#include <string>

#include "registration/scan/movement/uniform_light_frames.h"

namespace planlight {

/// The exponent that makes a camera's grey values proportional to light: 1 for a linear camera, about 2.2 for one that
/// encodes its pictures for a screen. Where a stripe's edge halves the light, a bit and its inverse together are then
/// brighter than white and black together; the exponent is the one with which they are alike. 1 also where that is
/// within 5 % of the contrast, or too few edges are seen. `frames`: white, black, and what `moments` counts, of one
/// camera.
double camera_gamma(const std::vector<GrayImage>& frames, const std::vector<UniformLightFrame>& moments);

/// "; the camera seems to encode its pictures for a screen (exponent 2.2): set it to linear (gamma 1, RAW)", where the
/// exponent is above 1.3; else empty. For what such a camera may be the cause of.
std::string said_of_gamma(double gamma);

/// `sum_uniform_light` of light instead of grey values: each grey value g is 255 (g / 255)^gamma first.
std::vector<float> even_light_picture(const std::vector<GrayImage>& frames, const UniformLightFrame& moment,
                                      double gamma);

}  // namespace planlight
