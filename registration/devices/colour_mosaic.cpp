#include "registration/devices/colour_mosaic.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

using Parities = std::array<double, 4>;  ///< upper left and right, lower left and right pixel of a square, mean grey

constexpr int kTile_px = 32;

Parities parities_of(const GrayImage& picture, int left, int top) {
    std::array<int, 4> sum{};
    for (int y = top; y < top + kTile_px; ++y)
        for (int x = left; x < left + kTile_px; ++x)
            sum[static_cast<std::size_t>(2 * (y & 1) + (x & 1))] += picture.at(x, y);
    Parities mean;
    for (std::size_t k = 0; k < 4; ++k) mean[k] = 4.0 * sum[k] / (kTile_px * kTile_px);
    return mean;
}

}  // namespace

bool is_colour_mosaic(const GrayImage& picture) {
    constexpr double kDark_grey = 20, kDiffers = 1.15, kDiffersHere = 1.08, kAlike = 0.25, kNearlyAll = 0.8;
    constexpr std::size_t kLeastTiles = 8;
    std::array<std::size_t, 2> green{};  // tiles whose falling (rising) diagonal is alike
    std::vector<double> ratios;
    for (int top = 0; top + kTile_px <= picture.height; top += kTile_px)
        for (int left = 0; left + kTile_px <= picture.width; left += kTile_px) {
            const Parities p = parities_of(picture, left, top);
            const auto [low, high] = std::minmax_element(p.begin(), p.end());
            if (*high < kDark_grey) continue;
            ratios.push_back(*high / std::max(1.0, *low));
            if (ratios.back() < kDiffersHere) continue;
            const double alike = kAlike * (*high - *low);
            green[0] += std::abs(p[0] - p[3]) < alike;
            green[1] += std::abs(p[1] - p[2]) < alike;
        }
    if (ratios.size() < kLeastTiles) return false;
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    return *middle > kDiffers &&
           static_cast<double>(std::max(green[0], green[1])) > kNearlyAll * static_cast<double>(ratios.size());
}

void refuse_colour_mosaic(const GrayImage& picture, const char* camera) {
    if (is_colour_mosaic(picture))
        throw CheckFailedError(
            fmt::format("the {} camera: these are raw pictures of a colour camera: every second pixel is brighter",
                        camera),
            kColourMosaicRemedy);
}

}  // namespace planlight
