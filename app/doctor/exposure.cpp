#include "app/doctor/exposure.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

constexpr int kSaturated = 254;

}  // namespace

Exposure exposure_of(const GrayImage& white, const GrayImage& black) {
    constexpr int kLit_grey = 10;
    std::size_t lit = 0, saturated = 0;
    std::vector<int> greys;
    for (std::size_t i = 0; i < white.pixels.size(); ++i) {
        if (white.pixels[i] - black.pixels[i] < kLit_grey) continue;
        ++lit;
        saturated += white.pixels[i] >= kSaturated;
        greys.push_back(white.pixels[i]);
    }
    Exposure exposure;
    if (lit == 0) return exposure;
    const auto bright = greys.begin() + static_cast<std::ptrdiff_t>(greys.size() * 95 / 100);
    std::nth_element(greys.begin(), bright, greys.end());
    exposure.brightest_lit_grey = *bright;
    exposure.lit_share = static_cast<double>(lit) / static_cast<double>(white.pixels.size());
    exposure.saturated_share = static_cast<double>(saturated) / static_cast<double>(lit);
    return exposure;
}

std::optional<double> fringe_share(const std::vector<GrayImage>& frames, const StripeSettings& stripes) {
    constexpr int kWellLit_grey = 30, kEnough = 100;
    const std::vector<StripePattern> sequence = stripe_sequence(stripes);
    if (frames.size() != sequence.size() || frames.size() < 2) return std::nullopt;
    std::vector<const GrayImage*> fringes;
    for (std::size_t i = 0; i < sequence.size(); ++i)
        if (sequence[i].kind == StripePattern::Kind::phase && !sequence[i].along_rows && sequence[i].frequency == 0)
            fringes.push_back(&frames[i]);
    if (fringes.size() < 3) return std::nullopt;
    const GrayImage &white = frames[0], &black = frames[1];
    std::vector<double> shares;
    for (std::size_t i = 0; i < white.pixels.size(); i += 3) {
        const int light = white.pixels[i] - black.pixels[i];
        if (light < kWellLit_grey || white.pixels[i] >= kSaturated) continue;
        std::complex<double> sum;
        for (std::size_t k = 0; k < fringes.size(); ++k)
            sum +=
                std::polar(1.0, 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(fringes.size())) *
                static_cast<double>(fringes[k]->pixels[i]);
        // Twice the amplitude, from dark to bright, over that of black to white.
        shares.push_back(4 / static_cast<double>(fringes.size()) * std::abs(sum) / light);
    }
    if (shares.size() < kEnough) return std::nullopt;
    return median(shares);
}

}  // namespace planlight
