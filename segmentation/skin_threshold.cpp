#include "segmentation/skin_threshold.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

struct Histogram {
    double low = 0, bin_width = 1;
    std::vector<double> counts;

    double centre(std::size_t bin) const { return low + (static_cast<double>(bin) + 0.5) * bin_width; }
    std::size_t bin(double value) const {
        return static_cast<std::size_t>(
            std::clamp((value - low) / bin_width, 0.0, static_cast<double>(counts.size()) - 1));
    }
};

Histogram histogram_of(const std::vector<float>& values, double low, double high, std::size_t bins) {
    Histogram h{low, (high - low) / static_cast<double>(bins), std::vector<double>(bins, 0.0)};
    const auto scale = static_cast<float>(1 / h.bin_width);
    const auto start = static_cast<float>(low);
    for (const float v : values) {
        const float at = (v - start) * scale;
        if (at >= 0 && at < static_cast<float>(bins)) h.counts[static_cast<std::size_t>(at)] += 1;
    }
    return h;
}

/// The centre of the fullest bin (of three-bin sums) of [from, to].
double peak(const Histogram& h, std::size_t from, std::size_t to) {
    std::size_t best = from;
    double most = -1;
    for (std::size_t b = from; b <= to; ++b) {
        const double sum = h.counts[b] + (b > from ? h.counts[b - 1] : 0) + (b < to ? h.counts[b + 1] : 0);
        if (sum > most) {
            most = sum;
            best = b;
        }
    }
    return h.centre(best);
}

double sum_of(const Histogram& h, std::size_t from, std::size_t to) {
    double sum = 0;
    for (std::size_t b = from; b <= to; ++b) sum += h.counts[b];
    return sum;
}

/// In the bin of that value and its two neighbours.
double count_near(const Histogram& h, double value) {
    const std::size_t b = h.bin(value);
    return sum_of(h, b > 0 ? b - 1 : 0, std::min(b + 1, h.counts.size() - 1));
}

std::size_t otsu(const Histogram& h) {
    double total = 0, moment = 0;
    for (std::size_t b = 0; b < h.counts.size(); ++b) {
        total += h.counts[b];
        moment += h.counts[b] * static_cast<double>(b);
    }
    double below = 0, below_moment = 0, best = -1;
    std::size_t at = 0;
    for (std::size_t b = 0; b + 1 < h.counts.size(); ++b) {
        below += h.counts[b];
        below_moment += h.counts[b] * static_cast<double>(b);
        const double above = total - below;
        if (below <= 0 || above <= 0) continue;
        const double difference = below_moment / below - (moment - below_moment) / above;
        const double between = below * above * difference * difference;
        if (between > best) {
            best = between;
            at = b;
        }
    }
    return at;
}

[[noreturn]] void refuse(const char* what) {
    throw InputError({}, std::string("There is no skin in the volume: ") + what,
                     "Check that the series shows the head with air round it, or give the threshold yourself.");
}

/// Where much of a CT has the lowest value that there is, above that of air, it was cut off there on the way here.
void check_not_cut_off(const Volume& volume) {
    constexpr double kMuch = 0.1;
    const auto [lowest, highest] = std::minmax_element(volume.values.begin(), volume.values.end());
    if (lowest == volume.values.end() || !(*highest > *lowest)) return;
    const double share = static_cast<double>(std::count(volume.values.begin(), volume.values.end(), *lowest)) /
                         static_cast<double>(volume.values.size());
    if (share < kMuch) return;
    throw InputError(
        {},
        fmt::format(
            "There is no air in the volume: {:.0f} % of its voxels have its lowest value, {:.0f} HU (the highest "
            "is {:.0f}), so that it was cut off there{}",
            100 * share, *lowest, *highest, *highest - *lowest <= 255 ? ", or put into 256 greys" : ""),
        "Export the series with all its values: without a window, 8 bits or a lower limit.");
}

}  // namespace

double skin_threshold(const Volume& volume, bool phantom) {
    const auto count = static_cast<double>(volume.values.size());
    if (volume.is_hu) {
        // A phantom may be of plastic or of bone, and small in its volume.
        const Histogram h =
            phantom ? histogram_of(volume.values, -1100, 3100, 420) : histogram_of(volume.values, -1100, 400, 150);
        const std::size_t air_end = h.bin(-705), soft_start = h.bin(phantom ? -395 : -95),
                          soft_end = h.bin(phantom ? 3095 : 145);
        if (sum_of(h, 0, air_end) < 0.005 * count) {
            check_not_cut_off(volume);
            refuse("no air");
        }
        double soft = peak(h, soft_start, soft_end), found = sum_of(h, soft_start, soft_end), least = -500;
        if (!phantom) {
            // A cone-beam CT's greys are HU only roughly: where soft tissue lies elsewhere, by far most of the body
            // does.
            const Histogram wide = histogram_of(volume.values, -1100, 700, 180);
            const double elsewhere = peak(wide, wide.bin(-445), wide.bin(415));
            if (count_near(wide, elsewhere) > 3 * count_near(wide, soft)) {
                soft = elsewhere;
                found = sum_of(wide, wide.bin(-445), wide.bin(415));
                least = -650;
            }
        }
        if (phantom ? found <= 0 : found < 0.005 * count) refuse(phantom ? "nothing in the air" : "no soft tissue");
        return std::clamp((peak(h, 0, air_end) + soft) / 2, least, -150.0);
    }
    float low = INFINITY, high = -INFINITY;
    for (const float v : volume.values)
        if (std::isfinite(v)) {
            low = std::min(low, v);
            high = std::max(high, v);
        }
    if (!(high > low)) refuse("all values are equal");
    const Histogram h = histogram_of(volume.values, low, high + (high - low) * 1e-6, 256);
    const std::size_t split = otsu(h);
    return (peak(h, 0, split) + peak(h, split + 1, h.counts.size() - 1)) / 2;
}

std::string threshold_text(double threshold) {
    constexpr int kDigits = 3, kMost = 15;
    const double size = std::abs(threshold);
    if (size == 0 || size >= 99.95) return fmt::format("{:.0f}", threshold);
    const int places = std::min(kMost, kDigits - 1 - static_cast<int>(std::floor(std::log10(size))));
    std::string text = fmt::format("{:.{}f}", threshold, places);
    if (text.find('.') == std::string::npos) return text;
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
}

}  // namespace planlight
