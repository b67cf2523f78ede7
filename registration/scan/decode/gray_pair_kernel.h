#pragma once

#include <cstddef>
#include <cstdint>

#include "registration/scan/decode/decode_kernels.h"

// The inner loops for a Gray code without fringes: whole projector pixels and the borders between two, so that 16 bits
// hold twice the number. Private to registration/scan.
namespace planlight::gray_pair_kernel {

/// A projector may have so many pixels a direction.
inline constexpr int kMostPixels = 32767;

/// No code; greater than any.
inline constexpr std::uint16_t kUnknown = 65535;

/// Twice the projector pixel of each code; odd between two pixels, where just the bit of their common border is in
/// doubt. kUnknown where another bit is, or where the number is not under `size` (at most kMostPixels). Reads and
/// writes multiples of 16.
void find_halves(const decode_kernels::CodeBytes& code, int size, std::uint16_t* halves, std::size_t n,
                 decode_kernels::LinesAhead& ahead);

/// `GrayCellSettings` in whole grey values.
struct Limits {
    int least_grey, saturated_at;
};

/// Whether a pixel is left that is lit, not saturated, and has at most one of the coarse bits in doubt. In the dark the
/// noise leaves none, and the finer bits need not be looked at.
bool any_left(const std::uint8_t* white, const std::uint8_t* black, const std::uint8_t* doubt, const Limits& limits,
              std::size_t n);

/// Writes column, row and, where they are known, `sigma_px`; NaN for the rest, which is counted by its reason. Past the
/// caches: nobody looks at the pixels again before all of them are there.
decode_kernels::Counts keep_pairs(const std::uint16_t* columns, const std::uint16_t* rows, const std::uint8_t* white,
                                  const std::uint8_t* black, const Limits& limits, float sigma_px, float* column,
                                  float* row, float* sigma, std::size_t n, decode_kernels::LinesAhead& ahead);

}  // namespace planlight::gray_pair_kernel
