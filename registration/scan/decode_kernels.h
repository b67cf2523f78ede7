#pragma once

#include <cstddef>
#include <cstdint>

// The inner loops of the decoder: plain arrays of `n` pixels, one call per frame and block of pixels.
namespace planlight::decode_kernels {

/// Adds a fringe frame, weighted by the sine and cosine of its shift; `top` keeps the brightest value.
void add_phase(const std::uint8_t* frame, float sine, float cosine, float* sine_sum, float* cosine_sum, std::uint8_t* top,
               std::size_t n);

/// The fringe amplitude (`amplitude_scale` is 2 / steps) and the phase as pixels in [-period/2, period/2].
void finish_phase(const float* sine_sum, const float* cosine_sum, float amplitude_scale, float period, float* amplitude,
                  float* phase_px, std::size_t n);

/// The grey difference below which a Gray bit is in doubt: a part of the fringe amplitude, at least `floor`.
void doubt_below(const float* amplitude, float part, float floor, std::int16_t* limit, std::size_t n);

/// Decides one bit (value `bit`) by the frame against its inverse.
void decide_bit(const std::uint8_t* frame, const std::uint8_t* inverse, const std::int16_t* limit, std::uint16_t bit,
                std::uint16_t* code, std::uint16_t* doubt, std::size_t n);

/// Decides one bit by the frame against the mean of white and black (the difference counts twice, as for an inverse).
void decide_bit_by_mean(const std::uint8_t* frame, const std::uint8_t* white, const std::uint8_t* black,
                        const std::int16_t* limit, std::uint16_t bit, std::uint16_t* code, std::uint16_t* doubt, std::size_t n);

/// Joins Gray code and phase to a projector pixel; NaN where they do not determine it. A bit in doubt is harmless
/// where the code with and without it unwraps to the same pixel (its own border); two are not.
void unwrap(const std::uint16_t* code, const std::uint16_t* doubt, const float* phase_px, float period, float size,
            float* pixel, std::size_t n);

}  // namespace planlight::decode_kernels
