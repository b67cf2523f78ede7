#include "registration/scan/decode_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#define PLANLIGHT_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

namespace planlight::decode_kernels {
namespace {

/// atan(t) for t in [0,1], to 1.2e-5 radians (minimax polynomial): 3e-5 pixels at a period of 16.
inline float arctan_unit(float t) {
    const float s = t * t;
    return t * (0.99997726f + s * (-0.33262347f + s * (0.19354346f + s * (-0.11643287f + s * (0.05265332f - s * 0.01172120f)))));
}

inline float arctan2(float y, float x) {
    constexpr float kHalfPi = 1.57079633f, kPi = 3.14159265f;
    const float ax = std::fabs(x), ay = std::fabs(y);
    const float big = ax > ay ? ax : ay, small = ax > ay ? ay : ax;
    float angle = arctan_unit(small / (big + 1e-20f));
    angle = ay > ax ? kHalfPi - angle : angle;
    angle = x < 0 ? kPi - angle : angle;
    return y < 0 ? -angle : angle;
}

inline std::uint16_t binary_from_gray(std::uint16_t g) {
    unsigned v = g;
    v ^= v >> 1;
    v ^= v >> 2;
    v ^= v >> 4;
    v ^= v >> 8;
    return static_cast<std::uint16_t>(v);
}

}  // namespace

PLANLIGHT_CLONES void add_phase(const std::uint8_t* frame, float sine, float cosine, float* sine_sum, float* cosine_sum,
                                std::uint8_t* top, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        const float value = frame[i];
        sine_sum[i] += sine * value;
        cosine_sum[i] += cosine * value;
        top[i] = top[i] > frame[i] ? top[i] : frame[i];
    }
}

PLANLIGHT_CLONES void finish_phase(const float* sine_sum, const float* cosine_sum, float amplitude_scale, float period,
                                   float* amplitude, float* phase_px, std::size_t n) {
    const float pixels_by_radian = period / 6.28318531f;
    for (std::size_t i = 0; i < n; ++i) {
        const float s = sine_sum[i], c = cosine_sum[i];
        amplitude[i] = amplitude_scale * std::sqrt(s * s + c * c);
        phase_px[i] = pixels_by_radian * arctan2(s, c);
    }
}

PLANLIGHT_CLONES void doubt_below(const float* amplitude, float part, float floor, std::int16_t* limit, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        const float wanted = part * amplitude[i];
        limit[i] = static_cast<std::int16_t>(static_cast<int>(wanted > floor ? wanted : floor));
    }
}

PLANLIGHT_CLONES void decide_bit(const std::uint8_t* frame, const std::uint8_t* inverse, const std::int16_t* limit,
                                 std::uint16_t bit, std::uint16_t* code, std::uint16_t* doubt, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        const auto difference = static_cast<std::int16_t>(frame[i] - inverse[i]);
        const auto size = static_cast<std::int16_t>(difference < 0 ? -difference : difference);
        code[i] = static_cast<std::uint16_t>(code[i] | (difference > 0 ? bit : 0));
        doubt[i] = static_cast<std::uint16_t>(doubt[i] | (size <= limit[i] ? bit : 0));
    }
}

PLANLIGHT_CLONES void decide_bit_by_mean(const std::uint8_t* frame, const std::uint8_t* white, const std::uint8_t* black,
                                         const std::int16_t* limit, std::uint16_t bit, std::uint16_t* code,
                                         std::uint16_t* doubt, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        const auto difference = static_cast<std::int16_t>(2 * frame[i] - white[i] - black[i]);
        const auto size = static_cast<std::int16_t>(difference < 0 ? -difference : difference);
        code[i] = static_cast<std::uint16_t>(code[i] | (difference > 0 ? bit : 0));
        doubt[i] = static_cast<std::uint16_t>(doubt[i] | (size <= limit[i] ? bit : 0));
    }
}

PLANLIGHT_CLONES void unwrap(const std::uint16_t* code, const std::uint16_t* doubt, const float* phase_px, float period,
                             float size, float* pixel, std::size_t n) {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    // A half period reaches a quarter of a period to either side of its centre; the phase may lie up to half a period
    // away before the order is wrong. Close to that end nothing is believed.
    constexpr float kMaxTurns = 0.44f;
    const float half = period / 2;
    for (std::size_t i = 0; i < n; ++i) {
        const float centre_a = (static_cast<float>(binary_from_gray(code[i])) + 0.5f) * half - 0.5f;
        const float centre_b =
            (static_cast<float>(binary_from_gray(static_cast<std::uint16_t>(code[i] ^ doubt[i]))) + 0.5f) * half - 0.5f;
        const float turns_a = (centre_a - phase_px[i]) / period, turns_b = (centre_b - phase_px[i]) / period;
        const float order_a = std::floor(turns_a + 0.5f), order_b = std::floor(turns_b + 0.5f);
        const float off_a = std::fabs(turns_a - order_a), off_b = std::fabs(turns_b - order_b);
        const float found = phase_px[i] + order_a * period;
        const bool one_doubt = (doubt[i] & static_cast<std::uint16_t>(doubt[i] - 1)) == 0;
        const bool good = bool(one_doubt & (order_a == order_b) & (std::min(off_a, off_b) <= kMaxTurns) & (found >= -0.5f) &
                               (found < size - 0.5f));
        pixel[i] = good ? found : kNaN;
    }
}

}  // namespace planlight::decode_kernels
