#include "projection/guide_light.h"

#include <algorithm>
#include <cmath>

#include "projection/stroke_font.h"
#include "projection/text_line.h"

namespace planlight {
namespace {

Rgb colour_of(GuideLight::Mood mood) {
    if (mood == GuideLight::Mood::hold) return {150, 205, 255};
    if (mood == GuideLight::Mood::taken) return {150, 255, 170};
    return {255, 205, 110};
}

std::uint8_t mixed(std::uint8_t colour, std::uint8_t share) {
    return static_cast<std::uint8_t>(255 - (255 - colour) * share / 255);
}

}  // namespace

RgbImage draw_guide_light(const GuideLight& light, int width, int height) {
    RgbImage mask(width, height);
    constexpr Rgb kFull{255, 255, 255};
    if (!light.words.empty()) {
        const double widest = 0.8 * width / std::max(0.1, text_width(code_points(light.words)));
        write_line(light.words, {width / 2.0, height / 2.0}, std::min(0.16 * height, widest), kFull, mask);
    }
    const int from = width / 10,
              to = from + static_cast<int>(std::lround(std::clamp(light.bar_share, 0.0, 1.0) * 0.8 * width)),
              top = height * 13 / 20, low = top + std::max(2, height / 40);
    if (light.bar_share > 0)
        for (int y = top; y < low; ++y)
            for (int x = from; x < to; ++x) mask.at(x, y) = kFull;
    const Rgb colour = colour_of(light.mood);
    RgbImage picture(width, height);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const std::uint8_t share = mask.pixels[i][0];
        picture.pixels[i] = {mixed(colour[0], share), mixed(colour[1], share), mixed(colour[2], share)};
    }
    return picture;
}

}  // namespace planlight
