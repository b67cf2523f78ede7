#pragma once

#include <array>
#include <cstddef>

#include "registration/scan/decode/decode_kernels.h"

// Which fringe a pixel lies in, by fringes of further frequencies. Private to registration/scan.
namespace planlight::fringe_order {

inline constexpr std::size_t kMostFrequencies = 8;  ///< beside the first

/// The further fringes of a block of pixels: amplitude and phase (turns, -1/2 to 1/2), one array a frequency.
struct Fringes {
    std::size_t count = 0;
    std::array<const float*, kMostFrequencies> amplitude, turns;
    std::array<float, kMostFrequencies> by_period;    ///< period of the first by this one's
    std::array<float, kMostFrequencies> sigma_turns;  ///< noise of a phase, by the inverse of the amplitude
    float first_sigma_turns = 0;
};

/// How sure an order must be. With weights by the noise of the phases (chi-square), an order that beats the runner-up
/// by `least_lead` is wrong where noise of sqrt(least_lead) sigma happens to point the right way: 4.5 sigma.
struct Sureness {
    float most_chi_square = 25, least_lead = 20;
    float allowed_turns = 0.01f;  ///< what gamma and movement add to a phase
};

/// The projector pixel of every pixel: that order of the first fringe (`phase_px` in [-period/2, period/2],
/// `amplitude`) at which all phases agree best, among the places within `size` (and what noise may add to them). NaN
/// where none agrees, another agrees nearly as well, or the pixel lies outside `size`.
void find_order(const float* phase_px, const float* amplitude, const Fringes& others, const Sureness& sure,
                float period, float size, float* pixel, std::size_t n);

}  // namespace planlight::fringe_order
