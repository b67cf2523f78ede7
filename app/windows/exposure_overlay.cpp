#include "app/windows/exposure_overlay.h"

#include <algorithm>

#include "registration/devices/clipped_pixels.h"

namespace planlight {
namespace {

constexpr int kStripe = 4;  // pixels of the picture as it is shown

struct Cell {
    int mean, greatest;
};

Cell cell_of(const GrayImage& picture, int x, int y, int by) {
    int sum = 0, greatest = 0;
    for (int v = 0; v < by; ++v)
        for (int u = 0; u < by; ++u) {
            const int grey = picture.at(x * by + u, y * by + v);
            sum += grey;
            greatest = std::max(greatest, grey);
        }
    return {sum / (by * by), greatest};
}

}  // namespace

RgbImage exposure_overlay(const GrayImage& picture, int by) {
    by = std::max(1, by);
    RgbImage shown(picture.width / by, picture.height / by);
    for (int y = 0; y < shown.height; ++y)
        for (int x = 0; x < shown.width; ++x) {
            const Cell cell = cell_of(picture, x, y, by);
            const auto grey = static_cast<std::uint8_t>(cell.mean);
            Rgb& pixel = shown.at(x, y) = {grey, grey, grey};
            if (cell.greatest >= kTooBright_grey && (x + y) / kStripe % 2 == 0) pixel = kTooBright_colour;
            if (cell.greatest < kTooDark_grey) {
                const auto green =
                    static_cast<std::uint8_t>(grey + kTooDark_colour[1]);  // what is seen there shows through
                pixel = {grey, green, kTooDark_colour[2]};
            }
        }
    return shown;
}

}  // namespace planlight
