#pragma once

#include <string>

#include "planning_io/types/image.h"

namespace planlight {

/// What the light on a calibration board says.
struct GuideLight {
    enum class Mood { wrong, hold, taken } mood = Mood::wrong;
    std::string words;     ///< a word or three, across the middle of the picture
    double bar_share = 0;  ///< 0 to 1: a bar under the words; 0: none
    bool operator==(const GuideLight&) const = default;
};

/// White all over, so that the cameras see the board as under the white picture of a scan, with the words in a pale
/// colour by mood (amber, blue, green): plain for a person, and with too little contrast to be taken for the print of a
/// board by a monochrome camera.
RgbImage draw_guide_light(const GuideLight& light, int width, int height);

}  // namespace planlight
