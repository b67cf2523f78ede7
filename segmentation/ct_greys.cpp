#include "segmentation/ct_greys.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace planlight {
namespace {

constexpr double kAir_hu = -1000, kSoft_hu = 35;
constexpr double kBin = 20, kLow = -700, kHigh = 700;
constexpr double kUsualLow = -150, kUsualHigh = 110;  // fat, muscle and brain, with contrast agent
constexpr double kShiftedLow = -450, kShiftedHigh = 420;
constexpr double kRound = 100, kFills = 0.3;  // of the body: brain, muscle and what noise makes of them

}  // namespace

double CtGreys::of(double hu) const {
    return usual ? hu : air + (hu - kAir_hu) * (soft - air) / (kSoft_hu - kAir_hu);
}

CtGreys ct_greys(const Volume& volume, const SkinMask& mask) {
    CtGreys greys;
    if (!volume.is_hu || mask.body.size() != volume.values.size()) return greys;
    std::array<double, static_cast<std::size_t>((kHigh - kLow) / kBin)> counts{};
    double body = 0;
    for (std::size_t i = 0; i < volume.values.size(); ++i) {
        const double v = volume.values[i];
        if (!mask.body[i] || !(v >= mask.threshold)) continue;
        ++body;
        if (v >= kLow && v < kHigh) ++counts[static_cast<std::size_t>((v - kLow) / kBin)];
    }
    std::size_t fullest = 1;
    const auto sum_at = [&](std::size_t b) { return counts[b - 1] + counts[b] + counts[b + 1]; };
    for (std::size_t b = 1; b + 1 < counts.size(); ++b)
        if (sum_at(b) > sum_at(fullest)) fullest = b;
    const double soft = kLow + (static_cast<double>(fullest) + 0.5) * kBin;
    constexpr auto kRoundBins = static_cast<std::size_t>(kRound / kBin);
    double round = 0;
    for (std::size_t b = fullest - std::min(fullest, kRoundBins);
         b <= std::min(counts.size() - 1, fullest + kRoundBins); ++b)
        round += counts[b];
    const bool elsewhere = soft < kUsualLow || soft > kUsualHigh;
    if (!elsewhere || soft < kShiftedLow || soft > kShiftedHigh || round < kFills * body) return greys;
    greys.usual = false;
    greys.soft = soft;
    return greys;
}

}  // namespace planlight
