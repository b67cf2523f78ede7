#include "registration/scan/decode/decode_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>

#include "planning_io/types/processor_clones.h"
#include "registration/scan/decode/write_past_cache.h"

namespace planlight::decode_kernels {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// atan(t) for t in [0,1], to 1.2e-5 radians (minimax polynomial): 3e-5 pixels at a period of 16.
PLANLIGHT_INLINE float arctan_unit(float t) {
    const float s = t * t;
    return t * (0.99997726f +
                s * (-0.33262347f + s * (0.19354346f + s * (-0.11643287f + s * (0.05265332f - s * 0.01172120f)))));
}

PLANLIGHT_INLINE float arctan2(float y, float x) {
    constexpr float kHalfPi = 1.57079633f, kPi = 3.14159265f;
    const float ax = std::fabs(x), ay = std::fabs(y);
    const float big = ax > ay ? ax : ay, small = ax > ay ? ay : ax;
    float angle = arctan_unit(small / (big + 1e-20f));
    angle = ay > ax ? kHalfPi - angle : angle;
    angle = x < 0 ? kPi - angle : angle;
    return y < 0 ? -angle : angle;
}

PLANLIGHT_INLINE int binary_from_gray(int v) {
    v ^= v >> 1;
    v ^= v >> 2;
    v ^= v >> 4;
    v ^= v >> 8;
    return v;
}

}  // namespace

typedef std::uint8_t Bytes __attribute__((vector_size(64)));

PLANLIGHT_CLONES int highest_contrast(const std::uint8_t* white, const std::uint8_t* black, std::size_t n) {
    Bytes most = {}, a, b;
    std::size_t i = 0;
    for (; i + sizeof most <= n; i += sizeof most) {
        std::memcpy(&a, white + i, sizeof a);
        std::memcpy(&b, black + i, sizeof b);
        const Bytes contrast = (a - b) & (Bytes)(a > b);
        most = most > contrast ? most : contrast;
    }
    int highest = 0;
    for (std::size_t lane = 0; lane < sizeof most; ++lane) highest = std::max<int>(highest, most[lane]);
    for (; i < n; ++i) highest = std::max(highest, white[i] - black[i]);
    return highest;
}

PLANLIGHT_CLONES void add_phase(const std::uint8_t* frame, float sine, float cosine, float* __restrict sine_sum,
                                float* __restrict cosine_sum, std::uint8_t* __restrict top, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        const float value = frame[i];
        sine_sum[i] += sine * value;
        cosine_sum[i] += cosine * value;
    }
    for (std::size_t i = 0; i < n; ++i) top[i] = top[i] > frame[i] ? top[i] : frame[i];
}

PLANLIGHT_CLONES void sum_eight_phases(const std::uint8_t* const* frames, float* __restrict sine_sum,
                                       float* __restrict cosine_sum, std::uint8_t* __restrict top, std::size_t n) {
    constexpr float kDiagonal = 0.70710678f;
    const std::uint8_t *f0 = frames[0], *f1 = frames[1], *f2 = frames[2], *f3 = frames[3], *f4 = frames[4],
                       *f5 = frames[5], *f6 = frames[6], *f7 = frames[7];
    for (std::size_t i = 0; i < n; ++i) {
        // Frames half a period apart have opposite weights.
        const int d0 = f0[i] - f4[i], d1 = f1[i] - f5[i], d2 = f2[i] - f6[i], d3 = f3[i] - f7[i];
        sine_sum[i] = static_cast<float>(d2) + kDiagonal * static_cast<float>(d1 + d3);
        cosine_sum[i] = static_cast<float>(d0) + kDiagonal * static_cast<float>(d1 - d3);
    }
    for (std::size_t i = 0; i < n; ++i) {
        const std::uint8_t a = f0[i] > f1[i] ? f0[i] : f1[i], b = f2[i] > f3[i] ? f2[i] : f3[i];
        const std::uint8_t c = f4[i] > f5[i] ? f4[i] : f5[i], d = f6[i] > f7[i] ? f6[i] : f7[i];
        const std::uint8_t e = a > b ? a : b, f = c > d ? c : d;
        top[i] = e > f ? e : f;
    }
}

PLANLIGHT_CLONES void finish_phase(const float* sine_sum, const float* cosine_sum, float amplitude_scale, float period,
                                   float* __restrict amplitude, float* __restrict phase_px, std::size_t n) {
    const float pixels_by_radian = period / 6.28318531f;
    for (std::size_t i = 0; i < n; ++i) {
        const float s = sine_sum[i], c = cosine_sum[i];
        amplitude[i] = amplitude_scale * std::sqrt(s * s + c * c);
        phase_px[i] = pixels_by_radian * arctan2(s, c);
    }
}

PLANLIGHT_CLONES void doubt_below(const float* amplitude, float part, float floor, std::uint8_t* __restrict limit,
                                  std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        const float wanted = part * amplitude[i], most = wanted > floor ? wanted : floor;
        limit[i] = static_cast<std::uint8_t>(static_cast<int>(most < 254.f ? most : 254.f));
    }
}

PLANLIGHT_CLONES void doubt_below_contrast(const std::uint8_t* white, const std::uint8_t* black, float part,
                                           float floor, std::uint8_t* __restrict limit, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        const float wanted = part * static_cast<float>(white[i] - black[i]), most = wanted > floor ? wanted : floor;
        // Rounded up, less one: a difference that reaches `most` is none in doubt. (256 - x rounds down what x rounds
        // up.)
        limit[i] = static_cast<std::uint8_t>(255 - static_cast<int>(256.f - (most < 255.f ? most : 255.f)));
    }
}

namespace {

/// The bits of `kVectors` x 64 pixels, in registers until all are decided. Of every frame several cache lines after
/// each other: memory gives runs of a frame much sooner than a line of each in turn.
template <int kVectors>
PLANLIGHT_INLINE void decide_run(const std::uint8_t* const* frames, const std::uint8_t* const* inverses,
                                 const std::uint8_t* middle, const std::uint8_t* limit_at, int count, std::size_t i,
                                 std::uint8_t* code_at, std::uint8_t* doubt_at) {
    Bytes code[kVectors], doubt[kVectors], limit[kVectors], a, b;
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v) {
        code[v] = doubt[v] = Bytes{};
        std::memcpy(&limit[v], limit_at + i + v * sizeof a, sizeof a);
    }
    for (int k = 0; k < count; ++k) {
        const auto bit = static_cast<std::uint8_t>(1u << (count - 1 - k));
        const std::uint8_t *frame = frames[k] + i, *other = inverses ? inverses[k] + i : middle + i;
#pragma GCC unroll 8
        for (std::size_t v = 0; v < kVectors; ++v) {
            std::memcpy(&a, frame + v * sizeof a, sizeof a);
            std::memcpy(&b, other + v * sizeof b, sizeof b);
            __builtin_prefetch(frame + v * sizeof a + kBlock);
            if (inverses) __builtin_prefetch(other + v * sizeof b + kBlock);
            const Bytes high = a > b ? a : b, low = a > b ? b : a;
            code[v] = a > b ? code[v] + bit : code[v];  // an addition under a mask
            doubt[v] = high - low <= limit[v] ? doubt[v] + bit : doubt[v];
        }
    }
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v) {
        std::memcpy(code_at + i + v * sizeof a, &code[v], sizeof a);
        std::memcpy(doubt_at + i + v * sizeof a, &doubt[v], sizeof a);
    }
}

}  // namespace

PLANLIGHT_CLONES void decide_bits(const std::uint8_t* const* frames, const std::uint8_t* const* inverses,
                                  const std::uint8_t* middle, const std::uint8_t* limit, int bits, std::uint8_t* code,
                                  std::uint8_t* doubt, std::size_t n) {
    constexpr std::size_t kRun = 512;
    std::size_t i = 0;
    for (; i + kRun <= n; i += kRun)
        decide_run<kRun / sizeof(Bytes)>(frames, inverses, middle, limit, bits, i, code, doubt);
    for (; i + sizeof(Bytes) <= n; i += sizeof(Bytes))
        decide_run<1>(frames, inverses, middle, limit, bits, i, code, doubt);
    for (; i < n; ++i) {
        unsigned set = 0, unsure = 0;
        for (int k = 0; k < bits; ++k) {
            const int a = frames[k][i], b = inverses ? inverses[k][i] : middle[i];
            set = 2 * set + (a > b);
            unsure = 2 * unsure + ((a > b ? a - b : b - a) <= limit[i]);
        }
        code[i] = static_cast<std::uint8_t>(set);
        doubt[i] = static_cast<std::uint8_t>(unsure);
    }
}

PLANLIGHT_CLONES void middle_of(const std::uint8_t* white, const std::uint8_t* black, const std::uint8_t* limit,
                                std::uint8_t* __restrict middle, std::uint8_t* __restrict half_limit, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        middle[i] = static_cast<std::uint8_t>((white[i] + black[i]) / 2);
        half_limit[i] = static_cast<std::uint8_t>((limit[i] + 1) / 2);
    }
}

PLANLIGHT_CLONES void unwrap(const CodeBytes& bytes, const float* phase_px, float period, float size,
                             float* __restrict pixel, std::size_t n) {
    // A half period reaches a quarter of a period to either side of its centre; the phase may lie up to half a period
    // away before the order is wrong. Close to that end nothing is believed.
    constexpr float kMaxTurns = 0.44f;
    const float half = period / 2, by_period = 1 / period;
    for (std::size_t i = 0; i < n; ++i) {
        const int code = bytes.low[i] | bytes.high[i] << 8, doubt = bytes.doubt_low[i] | bytes.doubt_high[i] << 8;
        const float centre_a = (static_cast<float>(binary_from_gray(code)) + 0.5f) * half - 0.5f;
        const float centre_b = (static_cast<float>(binary_from_gray(code ^ doubt)) + 0.5f) * half - 0.5f;
        const float turns_a = (centre_a - phase_px[i]) * by_period, turns_b = (centre_b - phase_px[i]) * by_period;
        // Rounded by truncation, for no turn is below -1.
        const float order_a = static_cast<float>(static_cast<int>(turns_a + 1.5f) - 1);
        const float order_b = static_cast<float>(static_cast<int>(turns_b + 1.5f) - 1);
        const float off_a = std::fabs(turns_a - order_a), off_b = std::fabs(turns_b - order_b);
        const float found = phase_px[i] + order_a * period, off = off_a < off_b ? off_a : off_b;
        const bool good = bool(((doubt & (doubt - 1)) == 0) & (order_a == order_b) & (off <= kMaxTurns) &
                               (found >= -0.5f) & (found < size - 0.5f));
        pixel[i] = good ? found : kNaN;
    }
}

PLANLIGHT_CLONES Counts keep_good(const DirectionBlock& columns, const DirectionBlock* rows, const std::uint8_t* white,
                                  const std::uint8_t* black, const Limits& limits, float* __restrict column,
                                  float* __restrict row, float* __restrict sigma_px, std::size_t n) {
    const DirectionBlock& second = rows ? *rows : columns;
    const Limits l = limits;
    int decoded = 0, saturated = 0, dark = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const float direct = l.min_direct_fraction * static_cast<float>(white[i] - black[i]);
        const float least = direct > l.min_modulation ? direct : l.min_modulation;
        const float first_amplitude = columns.amplitude[i], second_amplitude = second.amplitude[i];
        const float lesser = first_amplitude < second_amplitude ? first_amplitude : second_amplitude;
        const int first_bright = columns.top[i] >= l.saturated_at,
                  first_dark = (first_amplitude < least) & !first_bright;
        const int ahead = !(first_bright | first_dark);  // the first direction has said nothing against it
        // NaN is not equal to itself.
        const int first_good = ahead & (columns.pixel[i] == columns.pixel[i]) &
                               (l.sigma_by_inverse_amplitude <= l.max_sigma_px * first_amplitude);
        const int bright = first_bright | (first_good & (second.top[i] >= l.saturated_at));
        const int unlit = first_dark | (first_good & !bright & (second_amplitude < least));
        const int good = first_good & !bright & !unlit & (second.pixel[i] == second.pixel[i]) &
                         (l.sigma_by_inverse_amplitude <= l.max_sigma_px * lesser);
        column[i] = good ? columns.pixel[i] : kNaN;
        sigma_px[i] = good ? l.sigma_by_inverse_amplitude / first_amplitude : kNaN;
        decoded += good;
        saturated += bright;
        dark += unlit;
    }
    if (rows)
        for (std::size_t i = 0; i < n; ++i) row[i] = column[i] == column[i] ? second.pixel[i] : kNaN;
    return {static_cast<std::uint32_t>(decoded), static_cast<std::uint32_t>(dark),
            static_cast<std::uint32_t>(saturated),
            static_cast<std::uint32_t>(static_cast<int>(n) - decoded - dark - saturated)};
}

PLANLIGHT_CLONES bool any_lit(const float* amplitude, const std::uint8_t* top, const std::uint8_t* white,
                              const std::uint8_t* black, const Limits& limits, std::size_t n) {
    const Limits l = limits;
    int lit = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const float direct = l.min_direct_fraction * static_cast<float>(white[i] - black[i]);
        const float least = direct > l.min_modulation ? direct : l.min_modulation;
        lit |= (top[i] < l.saturated_at) & (amplitude[i] >= least);
    }
    return lit != 0;
}

PLANLIGHT_CLONES Counts keep_none(const std::uint8_t* top, int saturated_at, float* __restrict column,
                                  float* __restrict row, float* __restrict sigma_px, std::size_t n) {
    int saturated = 0;
    for (std::size_t i = 0; i < n; ++i) saturated += top[i] >= saturated_at;
    for (float* out : {column, row, sigma_px})
        if (out) fill_past_cache(kNaN, out, n);
    finish_writing();
    return {0, static_cast<std::uint32_t>(static_cast<int>(n) - saturated), static_cast<std::uint32_t>(saturated), 0};
}

}  // namespace planlight::decode_kernels
