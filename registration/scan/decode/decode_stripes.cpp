#include "registration/scan/decode/decode_stripes.h"

#include <fmt/format.h>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "planning_io/types/statistics.h"
#include "registration/scan/decode/decode_blocks.h"
#include "registration/scan/decode/fringe_order.h"
#include "registration/scan/decode/second_harmonic.h"

namespace planlight {
namespace {

namespace kernels = decode_kernels;
constexpr double kFallbackNoiseGrey = 2;

using Bytes = const std::uint8_t*;

/// The frames of one direction.
struct Direction {
    std::vector<Bytes> gray, inverse, phase;
    std::vector<std::vector<Bytes>> further;  ///< fringes of the further frequencies
    std::vector<SecondHarmonic> harmonics;    ///< of all frequencies; none but of three shifts
    int size = 0;                             ///< of the projector along it, pixels

    std::vector<Bytes>& fringes(int frequency) {
        return frequency == 0 ? phase : further[static_cast<std::size_t>(frequency - 1)];
    }
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
    for (Direction& direction : sorted.directions) direction.further.resize(stripes.order_periods_px.size());
    if (stripes.rows) sorted.directions[1].size = stripes.height;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const GrayImage& f = frames[i];
        if (f.width < 1 || f.height < 1 || f.width != width || f.height != height ||
            f.pixels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
            throw std::invalid_argument(
                fmt::format("decode_stripes: frame {} ({}) has {} x {} pixels, the first {} x {}", i, sequence[i].name,
                            f.width, f.height, width, height));
        Direction& direction = sorted.directions[sequence[i].along_rows ? 1 : 0];
        switch (sequence[i].kind) {
            case StripePattern::Kind::white:
                sorted.white = f.pixels.data();
                break;
            case StripePattern::Kind::black:
                sorted.black = f.pixels.data();
                break;
            case StripePattern::Kind::gray_bit:
                direction.gray.push_back(f.pixels.data());
                break;
            case StripePattern::Kind::gray_bit_inverse:
                direction.inverse.push_back(f.pixels.data());
                break;
            case StripePattern::Kind::phase:
                direction.fringes(sequence[i].frequency).push_back(f.pixels.data());
                break;
        }
    }
    return sorted;
}

/// Where it cannot be measured, so little is lit that it is taken for none.
void measure_harmonics(Frames& frames, std::size_t pixels) {
    for (Direction& direction : frames.directions) {
        direction.harmonics.resize(1 + direction.further.size());
        for (std::size_t k = 0; k < direction.harmonics.size(); ++k) {
            const std::vector<Bytes>& shifts = direction.fringes(static_cast<int>(k));
            if (shifts.size() != 3) continue;
            const auto share =
                measure_second_harmonic({shifts[0], shifts[1], shifts[2]}, frames.white, frames.black, pixels);
            if (share) direction.harmonics[k] = SecondHarmonic(*share);
        }
    }
}

/// Pixels to measure the noise on: runs of neighbours, so that each cache line read is used, evenly over the picture.
template <class Visit>
void for_sample(std::size_t pixels, const Visit& visit) {
    constexpr std::size_t kRun = 64, kMost = 20000;
    const std::size_t runs = std::max<std::size_t>(1, std::min(pixels, kMost) / kRun), every = pixels / runs;
    for (std::size_t begin = 0; begin < pixels; begin += every)
        for (std::size_t i = begin; i < std::min(begin + kRun, pixels); ++i) visit(i);
}

/// The noise of one grey value from the second harmonic of the fringes: a gamma makes one, but in phase with the
/// fringe (the fringe is even about its crest); what stands at right angles to it is noise.
double measure_noise(const Direction& direction, std::size_t pixels, const DecodeSettings& settings) {
    const std::size_t steps = direction.phase.size();
    if (steps < 5) return kFallbackNoiseGrey;
    std::vector<Eigen::Array4f> weights;  // sine and cosine of the first and second harmonic
    for (std::size_t k = 0; k < steps; ++k) {
        const double shift = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(steps);
        weights.push_back(
            Eigen::Array4d(std::sin(shift), std::cos(shift), std::sin(2 * shift), std::cos(2 * shift)).cast<float>());
    }
    std::vector<float> off;
    for_sample(pixels, [&](std::size_t i) {
        Eigen::Array4f sum = Eigen::Array4f::Zero();
        int top = 0;
        for (std::size_t k = 0; k < steps; ++k) {
            const int value = direction.phase[k][i];
            top = std::max(top, value);
            sum += weights[k] * static_cast<float>(value);
        }
        const float first = std::hypot(sum[0], sum[1]);
        if (top >= settings.saturated_at || first * 2 / static_cast<float>(steps) < 3 * settings.min_modulation) return;
        const float sine = sum[0] / first, cosine = sum[1] / first;
        const float sine_twice = 2 * sine * cosine, cosine_twice = cosine * cosine - sine * sine;
        const float quadrature = sum[2] * cosine_twice - sum[3] * sine_twice;
        const float in_phase = sum[2] * sine_twice + sum[3] * cosine_twice;
        const float by_phase_noise = 2 * in_phase / first;  // the reference phase is noisy as well
        off.push_back(std::abs(quadrature) /
                      std::sqrt(static_cast<float>(steps) / 2 * (1 + by_phase_noise * by_phase_noise)));
    });
    if (off.size() < 50) return kFallbackNoiseGrey;
    const auto middle = median(off);
    return std::max(1.4826 * middle, 0.29);  // 0.29: the rounding to whole grey values
}

/// Working arrays of one block of pixels, and what one direction says about it.
struct Block {
    alignas(64) std::array<float, kernels::kBlock> sine_sum, cosine_sum, amplitude, phase_px, pixel;
    alignas(64) std::array<std::uint8_t, kernels::kBlock> limit, top, middle, half_limit;
    alignas(64) kernels::CodeBytes code;
    /// Of the further frequencies.
    alignas(64) std::array<std::array<float, kernels::kBlock>, fringe_order::kMostFrequencies> further_amplitude,
        further_turns;

    kernels::DirectionBlock result() const { return {amplitude.data(), pixel.data(), top.data()}; }
};

struct Work {
    Block columns, rows;
};

/// Amplitude and phase (projector pixels, or turns with a period of 1) of one frequency.
void decode_phase(const std::vector<Bytes>& phase, const SecondHarmonic& harmonic, float period, std::size_t begin,
                  std::size_t n, Block& b, float* amplitude, float* phase_px) {
    const std::size_t steps = phase.size();
    if (steps == 8 && amplitude == b.amplitude.data()) {  // the first: the brightest value is set, not raised
        std::array<Bytes, 8> frames;
        for (std::size_t k = 0; k < steps; ++k) frames[k] = phase[k] + begin, kernels::expect_next(frames[k]);
        kernels::sum_eight_phases(frames.data(), b.sine_sum.data(), b.cosine_sum.data(), b.top.data(), n);
    } else {
        b.sine_sum.fill(0);
        b.cosine_sum.fill(0);
        for (std::size_t k = 0; k < steps; ++k) {
            const double shift = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(steps);
            kernels::add_phase(phase[k] + begin, static_cast<float>(std::sin(shift)),
                               static_cast<float>(std::cos(shift)), b.sine_sum.data(), b.cosine_sum.data(),
                               b.top.data(), n);
        }
    }
    kernels::finish_phase(b.sine_sum.data(), b.cosine_sum.data(), 2 / static_cast<float>(steps), period, amplitude,
                          phase_px, n);
    harmonic.take_out(phase_px, amplitude, period, n);
}

/// One standard deviation of a phase in turns, by the inverse of its amplitude.
float sigma_turns(int steps, double noise_grey) {
    return static_cast<float>(std::sqrt(2.0 / steps) * noise_grey / (2 * std::numbers::pi));
}

/// The order of the fringes by those of further frequencies. A frequency without light there has no say, and no order
/// is sure.
void order_by_fringes(const Direction& direction, const StripeSettings& stripes, double noise_grey, std::size_t begin,
                      std::size_t n, Block& b) {
    fringe_order::Fringes others;
    others.count = direction.further.size();
    others.first_sigma_turns = sigma_turns(stripes.phase_steps, noise_grey);
    for (std::size_t k = 0; k < others.count; ++k) {
        decode_phase(direction.further[k], direction.harmonics[k + 1], 1, begin, n, b, b.further_amplitude[k].data(),
                     b.further_turns[k].data());
        others.amplitude[k] = b.further_amplitude[k].data();
        others.turns[k] = b.further_turns[k].data();
        others.by_period[k] = static_cast<float>(stripes.phase_period_px / stripes.order_periods_px[k]);
        others.sigma_turns[k] = sigma_turns(stripes.order_steps, noise_grey);
    }
    fringe_order::find_order(b.phase_px.data(), b.amplitude.data(), others, {},
                             static_cast<float>(stripes.phase_period_px), static_cast<float>(direction.size),
                             b.pixel.data(), n);
}

/// Amplitude and phase of the first frequency.
void decode_fringes(const Direction& direction, const StripeSettings& stripes, std::size_t begin, std::size_t n,
                    Block& b) {
    b.top.fill(0);
    decode_phase(direction.phase, direction.harmonics[0], static_cast<float>(stripes.phase_period_px), begin, n, b,
                 b.amplitude.data(), b.phase_px.data());
}

/// Then the rest of the code.
void decode_order(const Frames& frames, const Direction& direction, const StripeSettings& stripes, double noise_grey,
                  std::size_t begin, std::size_t n, Block& b) {
    if (!direction.further.empty()) return order_by_fringes(direction, stripes, noise_grey, begin, n, b);
    // A clear bit differs by two amplitudes or more; a quarter of that, or 3 sigma of a difference, is doubt.
    kernels::doubt_below(b.amplitude.data(), 0.5f, static_cast<float>(3 * std::numbers::sqrt2 * noise_grey),
                         b.limit.data(), n);
    if (!stripes.inverse)
        kernels::middle_of(frames.white + begin, frames.black + begin, b.limit.data(), b.middle.data(),
                           b.half_limit.data(), n);
    std::array<Bytes, kernels::kMostBits> bits, inverses;
    for (std::size_t k = 0; k < direction.gray.size(); ++k) {
        bits[k] = direction.gray[k] + begin;
        if (stripes.inverse) inverses[k] = direction.inverse[k] + begin;
    }
    const std::uint8_t* limit = stripes.inverse ? b.limit.data() : b.half_limit.data();
    const int count = static_cast<int>(direction.gray.size()), coarse = kernels::coarse_bits(count);
    const auto decide = [&](int first, int some, std::uint8_t* code, std::uint8_t* doubt) {
        kernels::decide_bits(bits.data() + first, stripes.inverse ? inverses.data() + first : nullptr, b.middle.data(),
                             limit, some, code, doubt, n);
    };
    decide(0, coarse, b.code.high, b.code.doubt_high);
    decide(coarse, count - coarse, b.code.low, b.code.doubt_low);
    kernels::unwrap(b.code, b.phase_px.data(), static_cast<float>(stripes.phase_period_px),
                    static_cast<float>(direction.size), b.pixel.data(), n);
}

/// Decodes the pixels [begin, begin + n) of the view.
kernels::Counts decode_into(const Frames& frames, const StripeSettings& stripes, const kernels::Limits& limits,
                            std::size_t begin, std::size_t n, Work& work, DecodedView& view) {
    const Bytes white = frames.white + begin, black = frames.black + begin;
    kernels::expect_next(white, kernels::kFarAhead);
    kernels::expect_next(black, kernels::kFarAhead);
    float *column = view.column.data() + begin, *row = stripes.rows ? view.row.data() + begin : nullptr,
          *sigma = view.sigma_px.data() + begin;
    // A fringe is never stronger than the light itself; most of a picture shows what no light falls on.
    if (static_cast<float>(kernels::highest_contrast(white, black, n)) < limits.min_modulation)
        return kernels::keep_none(white, limits.saturated_at, column, row, sigma, n);
    decode_fringes(frames.directions[0], stripes, begin, n, work.columns);
    const kernels::DirectionBlock columns = work.columns.result(), rows = work.rows.result();
    if (!kernels::any_lit(columns.amplitude, columns.top, white, black, limits, n))
        return kernels::keep_none(columns.top, limits.saturated_at, column, row, sigma, n);
    decode_order(frames, frames.directions[0], stripes, view.noise_grey, begin, n, work.columns);
    if (stripes.rows) {
        decode_fringes(frames.directions[1], stripes, begin, n, work.rows);
        decode_order(frames, frames.directions[1], stripes, view.noise_grey, begin, n, work.rows);
    }
    return kernels::keep_good(columns, stripes.rows ? &rows : nullptr, white, black, limits, column, row, sigma, n);
}

}  // namespace

DecodedView decode_stripes(std::span<const GrayImage> frames, const StripeSettings& stripes,
                           const DecodeSettings& settings) {
    Frames sorted = sort_frames(frames, stripes);
    DecodedView view = empty_view(frames[0].width, frames[0].height, stripes.rows);
    const std::size_t pixels = frames[0].pixels.size();
    measure_harmonics(sorted, pixels);
    view.noise_grey =
        settings.noise_grey > 0 ? settings.noise_grey : measure_noise(sorted.directions[0], pixels, settings);
    const kernels::Limits limits{static_cast<float>(settings.min_modulation),
                                 static_cast<float>(settings.min_direct_fraction),
                                 static_cast<float>(stripes.phase_period_px / (2 * std::numbers::pi) *
                                                    std::sqrt(2.0 / stripes.phase_steps) * view.noise_grey),
                                 static_cast<float>(settings.max_phase_sigma_px), settings.saturated_at};
    decode_by_blocks<Work>(view, [&](std::size_t begin, std::size_t n, Work& work) {
        return decode_into(sorted, stripes, limits, begin, n, work, view);
    });
    return view;
}

}  // namespace planlight
