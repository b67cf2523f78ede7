#include "registration/devices/focus_measure.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "registration/devices/clipped_pixels.h"

namespace planlight {
namespace {

constexpr int kReach = 3;  // pixels, of the Gaussian to either side

struct Kernels {
    std::array<float, 2 * kReach + 1> smooth{}, slope{};  ///< Gaussian of one pixel, and its derivative
    double noise_gain = 0;                                ///< mean squared gradient of white noise of one grey value
};

Kernels gaussian_kernels() {
    Kernels k;
    double sum = 0, lever = 0;
    for (int i = -kReach; i <= kReach; ++i) sum += std::exp(-0.5 * i * i);
    for (int i = -kReach; i <= kReach; ++i) lever += i * i * std::exp(-0.5 * i * i);
    double smooth_squares = 0, slope_squares = 0;
    for (int i = -kReach; i <= kReach; ++i) {
        const double g = std::exp(-0.5 * i * i) / sum, d = i * std::exp(-0.5 * i * i) / lever;
        k.smooth[static_cast<std::size_t>(i + kReach)] = static_cast<float>(g);
        k.slope[static_cast<std::size_t>(i + kReach)] = static_cast<float>(d);
        smooth_squares += g * g;
        slope_squares += d * d;
    }
    k.noise_gain = 2 * smooth_squares * slope_squares;
    return k;
}

/// One row, smoothed and differentiated along itself; and where a saturated pixel is in reach.
struct FilteredRow {
    std::vector<float> smooth, slope;
    std::vector<std::uint8_t> saturated;
};

void filter_row(const GrayImage& picture, const std::array<int, 4>& region, int y, const Kernels& k, FilteredRow& row) {
    const auto width = static_cast<std::size_t>(region[2]);
    row.smooth.assign(width, 0);
    row.slope.assign(width, 0);
    row.saturated.assign(width, 0);
    for (std::size_t x = 0; x < width; ++x) {
        const std::uint8_t* from = &picture.pixels[picture.index(region[0] + static_cast<int>(x) - kReach, y)];
        for (std::size_t i = 0; i < k.smooth.size(); ++i) {
            row.smooth[x] += k.smooth[i] * from[i];
            row.slope[x] += k.slope[i] * from[i];
            row.saturated[x] |= from[i] >= kTooBright_grey;
        }
    }
}

/// One standard deviation of the noise, grey values: what is left of the picture after two second differences across
/// each other, which edges and shades do not survive.
double noise_of(const GrayImage& picture, const std::array<int, 4>& region) {
    std::vector<std::size_t> count(16 * 255 + 1);
    std::size_t all = 0;
    for (int y = region[1]; y < region[1] + region[3]; ++y)
        for (int x = region[0]; x < region[0] + region[2]; ++x) {
            const auto second = [&](int row) {
                return picture.at(x - 1, row) - 2 * picture.at(x, row) + picture.at(x + 1, row);
            };
            ++count[static_cast<std::size_t>(std::abs(second(y - 1) - 2 * second(y) + second(y + 1)))];
            ++all;
        }
    // The median of the size, between whole numbers; of normal noise that is 0.6745 times its sigma, and the mask's
    // squares add up to 36.
    std::size_t below = 0, value = 0;
    while (below + count[value] < all / 2) below += count[value++];
    const double into = count[value] > 0 ? static_cast<double>(all / 2 - below) / static_cast<double>(count[value]) : 0;
    const double median = value == 0 ? 0.5 * into : static_cast<double>(value) - 0.5 + into;
    return median / (0.6745 * 6);
}

struct Sums {
    double squared_gradient = 0, grey = 0;
    std::size_t pixels = 0;
};

/// Of the row in the middle of `rows`, which stands in `middle` in the picture.
void add_row(const std::vector<FilteredRow>& rows, int middle, const Kernels& k, Sums& sums) {
    const std::size_t width = rows.front().smooth.size(), high = k.smooth.size();
    for (std::size_t x = 0; x < width; ++x) {
        float right = 0, down = 0, grey = 0;
        bool saturated = false;
        for (std::size_t j = 0; j < high; ++j) {
            const FilteredRow& row = rows[(static_cast<std::size_t>(middle) + j) % high];
            right += k.smooth[j] * row.slope[x];
            down += k.slope[j] * row.smooth[x];
            grey += k.smooth[j] * row.smooth[x];
            saturated = saturated || row.saturated[x] != 0;
        }
        if (saturated) continue;
        sums.squared_gradient += right * right + down * down;
        sums.grey += grey;
        ++sums.pixels;
    }
}

}  // namespace

std::array<int, 4> focus_region(const GrayImage& picture) {
    return {picture.width / 4, picture.height / 4, picture.width / 2, picture.height / 2};
}

double focus_measure(const GrayImage& picture) {
    constexpr double kDark_grey = 2;
    static const Kernels k = gaussian_kernels();
    const std::array<int, 4> region = focus_region(picture);
    if (region[0] < kReach || region[1] < kReach) return 0;
    std::vector<FilteredRow> rows(k.smooth.size());  // a ring: row y stands in y mod its size
    const auto place = [&](int y) -> FilteredRow& { return rows[static_cast<std::size_t>(y) % rows.size()]; };
    for (int y = region[1] - kReach; y < region[1] + kReach; ++y) filter_row(picture, region, y, k, place(y));
    Sums sums;
    for (int y = region[1]; y < region[1] + region[3]; ++y) {
        filter_row(picture, region, y + kReach, k, place(y + kReach));
        add_row(rows, y - kReach, k, sums);
    }
    if (sums.pixels == 0) return 0;
    const auto pixels = static_cast<double>(sums.pixels);
    const double mean = sums.grey / pixels, noise = noise_of(picture, region);
    if (mean < kDark_grey) return 0;
    return 100 * std::sqrt(std::max(0.0, sums.squared_gradient / pixels - k.noise_gain * noise * noise)) / mean;
}

}  // namespace planlight
