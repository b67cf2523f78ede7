#include "registration/scan/check/picture_noise.h"
#include "planning_io/types/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace planlight {
namespace {

constexpr std::size_t kPlaces = 20000, kEnough = 100;
constexpr double kMedianOfNormal = 0.6745;  // of the size of a normal value of sigma 1

double median_of_enough(std::vector<int> sizes) {
    return sizes.size() < kEnough ? 0 : median(std::move(sizes));
}

/// Calls `look` with white - black of about kPlaces pixels and of the next ones to the right.
template <class Look>
void each_place(const GrayImage& white, const GrayImage& black, const Look& look) {
    const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(white.pixels.size() / kPlaces))));
    for (int y = 0; y < white.height; y += step)
        for (int x = 0; x + 1 < white.width; x += step) {
            const std::size_t i = white.index(x, y);
            look(white.pixels[i] - black.pixels[i], white.pixels[i + 1] - black.pixels[i + 1]);
        }
}

}  // namespace

double noise_in_light(const GrayImage& white, const GrayImage& black) {
    constexpr int kLeast_grey = 16;
    std::vector<int> sizes;
    each_place(white, black, [&](int here, int next) {
        if (here >= kLeast_grey) sizes.push_back(std::abs(here - next));
    });
    return median_of_enough(std::move(sizes)) / (2 * kMedianOfNormal);
}

double noise_in_dark(const GrayImage& white, const GrayImage& black) {
    std::vector<int> sizes;
    each_place(white, black, [&](int here, int) {
        if (here < 0) sizes.push_back(-here);
    });
    return median_of_enough(std::move(sizes)) / (std::sqrt(2.0) * kMedianOfNormal);
}

}  // namespace planlight
