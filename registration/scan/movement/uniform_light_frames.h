#pragma once

#include <string>
#include <vector>

#include "registration/scan/scan_surface.h"

namespace planlight {

/// A moment of a scan under even light: a bit with its inverse, or all fringes of a direction, summed. What is drawn on
/// the patient cancels; the skin and its markers stay.
struct UniformLightFrame {
    std::string name;                 ///< of the first picture that takes part
    double when = 0;                  ///< the middle of its pictures as a share of the sequence, 0 to 1
    std::vector<std::size_t> frames;  ///< which pictures of the capture
};

/// In the order of capture: white + black first, then one for each bit (where its inverse was captured) and one for the
/// fringes of each direction.
std::vector<UniformLightFrame> uniform_light_frames(const ScanCapture& capture);

/// The sum of a camera's pictures, grey, scaled to two: as of white light and black together.
std::vector<float> sum_uniform_light(const std::vector<GrayImage>& frames, const UniformLightFrame& moment);

/// The same as 8 bits, halved so that it fits.
GrayImage half_uniform_light(const std::vector<GrayImage>& frames, const UniformLightFrame& moment);

}  // namespace planlight
