#include "registration/scan/decode_stripes.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "registration/scan/decode_kernels.h"

namespace planlight {
namespace {

constexpr std::size_t kBlock = 2048;  // pixels whose working arrays stay in the first cache levels
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kFallbackNoiseGrey = 2;

using Bytes = const std::uint8_t*;

/// The frames of one direction.
struct Direction {
    std::vector<Bytes> gray, inverse, phase;
    int size = 0;  ///< of the projector along it, pixels
};

struct Frames {
    Bytes white = nullptr, black = nullptr;
    std::vector<Direction> directions;  ///< columns, then rows if coded
};

Frames sort_frames(std::span<const GrayImage> frames, const StripeSettings& stripes) {
    const auto sequence = stripe_sequence(stripes);
    if (frames.size() != sequence.size())
        throw std::invalid_argument(
            fmt::format("decode_stripes: {} frames for a sequence of {} pictures", frames.size(), sequence.size()));
    const int width = frames[0].width, height = frames[0].height;
    Frames sorted;
    sorted.directions.resize(stripes.rows ? 2 : 1);
    sorted.directions[0].size = stripes.width;
    if (stripes.rows) sorted.directions[1].size = stripes.height;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const GrayImage& f = frames[i];
        if (f.width < 1 || f.height < 1 || f.width != width || f.height != height ||
            f.pixels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
            throw std::invalid_argument(fmt::format("decode_stripes: frame {} ({}) has {} x {} pixels, the first {} x {}", i,
                                                    sequence[i].name, f.width, f.height, width, height));
        Direction& direction = sorted.directions[sequence[i].along_rows ? 1 : 0];
        switch (sequence[i].kind) {
            case StripePattern::Kind::white: sorted.white = f.pixels.data(); break;
            case StripePattern::Kind::black: sorted.black = f.pixels.data(); break;
            case StripePattern::Kind::gray_bit: direction.gray.push_back(f.pixels.data()); break;
            case StripePattern::Kind::gray_bit_inverse: direction.inverse.push_back(f.pixels.data()); break;
            case StripePattern::Kind::phase: direction.phase.push_back(f.pixels.data()); break;
        }
    }
    return sorted;
}

/// The noise of one grey value from the second harmonic of the fringes: a gamma makes one, but in phase with the
/// fringe (the fringe is even about its crest); what stands at right angles to it is noise.
double measure_noise(const Direction& direction, std::size_t pixels, const DecodeSettings& settings) {
    const std::size_t steps = direction.phase.size();
    if (steps < 5) return kFallbackNoiseGrey;
    const std::size_t stride = std::max<std::size_t>(1, pixels / 40000);
    std::vector<double> off;
    for (std::size_t i = 0; i < pixels; i += stride) {
        std::array<double, 4> sum{};  // sine and cosine of the first and second harmonic
        int top = 0;
        for (std::size_t k = 0; k < steps; ++k) {
            const double shift = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(steps);
            const int value = direction.phase[k][i];
            top = std::max(top, value);
            sum[0] += value * std::sin(shift);
            sum[1] += value * std::cos(shift);
            sum[2] += value * std::sin(2 * shift);
            sum[3] += value * std::cos(2 * shift);
        }
        const double first = std::hypot(sum[0], sum[1]), theta = 2 * std::atan2(sum[0], sum[1]);
        if (top >= settings.saturated_at || first * 2 / static_cast<double>(steps) < 3 * settings.min_modulation) continue;
        const double quadrature = sum[2] * std::cos(theta) - sum[3] * std::sin(theta);
        const double in_phase = sum[2] * std::sin(theta) + sum[3] * std::cos(theta);
        const double by_phase_noise = 2 * in_phase / first;  // the reference phase is noisy as well
        off.push_back(std::abs(quadrature) / std::sqrt(static_cast<double>(steps) / 2 * (1 + by_phase_noise * by_phase_noise)));
    }
    if (off.size() < 50) return kFallbackNoiseGrey;
    const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    std::nth_element(off.begin(), middle, off.end());
    return std::max(1.4826 * *middle, 0.29);  // 0.29: the rounding to whole grey values
}

/// Working arrays of one block of pixels, and what one direction says about it.
struct Block {
    std::array<float, kBlock> sine_sum, cosine_sum, amplitude, phase_px, pixel;
    std::array<std::int16_t, kBlock> limit;
    std::array<std::uint16_t, kBlock> code, doubt;
    std::array<std::uint8_t, kBlock> top;
};

void decode_block(const Frames& frames, const Direction& direction, const StripeSettings& stripes, double noise_grey,
                  std::size_t begin, std::size_t n, Block& b) {
    b.sine_sum.fill(0);
    b.cosine_sum.fill(0);
    b.code.fill(0);
    b.doubt.fill(0);
    b.top.fill(0);
    const auto steps = static_cast<double>(direction.phase.size());
    for (std::size_t k = 0; k < direction.phase.size(); ++k) {
        const double shift = 2 * std::numbers::pi * static_cast<double>(k) / steps;
        decode_kernels::add_phase(direction.phase[k] + begin, static_cast<float>(std::sin(shift)),
                                  static_cast<float>(std::cos(shift)), b.sine_sum.data(), b.cosine_sum.data(), b.top.data(), n);
    }
    const auto period = static_cast<float>(stripes.phase_period_px);
    decode_kernels::finish_phase(b.sine_sum.data(), b.cosine_sum.data(), static_cast<float>(2 / steps), period,
                                 b.amplitude.data(), b.phase_px.data(), n);
    // A clear bit differs by two amplitudes or more; a quarter of that, or 3 sigma of a difference, is doubt.
    decode_kernels::doubt_below(b.amplitude.data(), 0.5f, static_cast<float>(3 * std::numbers::sqrt2 * noise_grey),
                                b.limit.data(), n);
    const std::size_t bits = direction.gray.size();
    for (std::size_t k = 0; k < bits; ++k) {
        const auto bit = static_cast<std::uint16_t>(1u << (bits - 1 - k));
        if (stripes.inverse)
            decode_kernels::decide_bit(direction.gray[k] + begin, direction.inverse[k] + begin, b.limit.data(), bit,
                                       b.code.data(), b.doubt.data(), n);
        else
            decode_kernels::decide_bit_by_mean(direction.gray[k] + begin, frames.white + begin, frames.black + begin,
                                               b.limit.data(), bit, b.code.data(), b.doubt.data(), n);
    }
    decode_kernels::unwrap(b.code.data(), b.doubt.data(), b.phase_px.data(), period, static_cast<float>(direction.size),
                           b.pixel.data(), n);
}

struct Limits {
    float min_modulation, min_direct_fraction, sigma_by_inverse_amplitude, max_sigma_px;
    int saturated_at;
};

/// What became of a pixel in one direction.
enum class Fate { decoded, dark, saturated, uncertain };

Fate judge(const Block& b, std::size_t i, int contrast, const Limits& limits) {
    if (b.top[i] >= limits.saturated_at) return Fate::saturated;
    if (b.amplitude[i] < limits.min_modulation || b.amplitude[i] < limits.min_direct_fraction * static_cast<float>(contrast))
        return Fate::dark;
    if (std::isnan(b.pixel[i]) || limits.sigma_by_inverse_amplitude > limits.max_sigma_px * b.amplitude[i])
        return Fate::uncertain;
    return Fate::decoded;
}

struct Counts {
    std::atomic<std::size_t> decoded{0}, dark{0}, saturated{0}, uncertain{0};
};

void keep_block(const Frames& frames, const Block& columns, const Block* rows, const Limits& limits, std::size_t begin,
                std::size_t n, DecodedView& view, Counts& counts) {
    std::array<std::size_t, 4> seen{};
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t p = begin + i;
        const int contrast = frames.white[p] - frames.black[p];
        Fate fate = judge(columns, i, contrast, limits);
        if (fate == Fate::decoded && rows) fate = judge(*rows, i, contrast, limits);
        ++seen[static_cast<std::size_t>(fate)];
        const bool good = fate == Fate::decoded;
        view.column[p] = good ? columns.pixel[i] : kNaN;
        if (rows) view.row[p] = good ? rows->pixel[i] : kNaN;
        view.sigma_px[p] = good ? limits.sigma_by_inverse_amplitude / columns.amplitude[i] : kNaN;
    }
    counts.decoded += seen[0];
    counts.dark += seen[1];
    counts.saturated += seen[2];
    counts.uncertain += seen[3];
}

}  // namespace

DecodedView decode_stripes(std::span<const GrayImage> frames, const StripeSettings& stripes, const DecodeSettings& settings) {
    const Frames sorted = sort_frames(frames, stripes);
    DecodedView view;
    view.width = frames[0].width;
    view.height = frames[0].height;
    const std::size_t pixels = frames[0].pixels.size();
    view.column.resize(pixels);
    if (stripes.rows) view.row.resize(pixels);
    view.sigma_px.resize(pixels);
    view.noise_grey = settings.noise_grey > 0 ? settings.noise_grey : measure_noise(sorted.directions[0], pixels, settings);
    const Limits limits{static_cast<float>(settings.min_modulation), static_cast<float>(settings.min_direct_fraction),
                        static_cast<float>(stripes.phase_period_px / (2 * std::numbers::pi) *
                                           std::sqrt(2.0 / stripes.phase_steps) * view.noise_grey),
                        static_cast<float>(settings.max_phase_sigma_px), settings.saturated_at};
    Counts counts;
    const std::size_t blocks = (pixels + kBlock - 1) / kBlock;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 16), [&](const tbb::blocked_range<std::size_t>& range) {
        const auto columns = std::make_unique<Block>();
        const auto rows = stripes.rows ? std::make_unique<Block>() : nullptr;
        for (std::size_t block = range.begin(); block < range.end(); ++block) {
            const std::size_t begin = block * kBlock, n = std::min(kBlock, pixels - begin);
            decode_block(sorted, sorted.directions[0], stripes, view.noise_grey, begin, n, *columns);
            if (rows) decode_block(sorted, sorted.directions[1], stripes, view.noise_grey, begin, n, *rows);
            keep_block(sorted, *columns, rows.get(), limits, begin, n, view, counts);
        }
    });
    view.decoded = counts.decoded;
    view.dark = counts.dark;
    view.saturated = counts.saturated;
    view.uncertain = counts.uncertain;
    return view;
}

}  // namespace planlight
