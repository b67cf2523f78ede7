#include "app/windows/camera_picture.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace planlight {

GrayImage shrunk(const GrayImage& picture, int by) {
    if (by <= 1) return picture;
    GrayImage small(picture.width / by, picture.height / by);
    const int half = by * by / 2;
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x) {
            int sum = half;
            for (int v = 0; v < by; ++v)
                for (int u = 0; u < by; ++u) sum += picture.at(x * by + u, y * by + v);
            small.at(x, y) = static_cast<std::uint8_t>(sum / (by * by));
        }
    return small;
}

GrayImage brightened(GrayImage picture) {
    std::array<std::size_t, 256> count{};
    for (const auto value : picture.pixels) ++count[value];
    std::size_t white = 255;
    for (std::size_t above = 0; white > 16; --white) {
        above += count[white];
        if (above > picture.pixels.size() / 200) break;
    }
    std::array<std::uint8_t, 256> bright{};
    for (std::size_t value = 0; value < bright.size(); ++value)
        bright[value] = static_cast<std::uint8_t>(std::min<std::size_t>(255, value * 255 / white));
    for (auto& value : picture.pixels) value = bright[value];
    return picture;
}

RgbImage rgb_of(const GrayImage& picture) {
    RgbImage rgb(picture.width, picture.height);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) rgb.pixels[i].fill(picture.pixels[i]);
    return rgb;
}

}  // namespace planlight
