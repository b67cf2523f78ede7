#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "planning_io/types/image.h"
#include "registration/scan/pattern/stripe_patterns.h"

namespace planlight {

/// What three shifts cannot tell from their fringe: cos x + r cos 2x, sampled at three thirds of a period, has the
/// phase of e^ix + r e^-2ix. A gamma of 2.2 makes r = 0.29 (less where the fringe is blurred), which shifts the phase
/// by up to a twentieth of a period; four shifts and more do not see it. Private to registration/scan.
class SecondHarmonic {
public:
    SecondHarmonic() = default;  ///< none
    explicit SecondHarmonic(double share);

    double share() const { return share_; }  ///< r
    /// From the phases as sampled (pixels, -period/2 to period/2) and their amplitudes to those of the fringe. An
    /// amplitude becomes that of a fringe whose phase would be as certain; 0 where the phase does not say the place
    /// (r of about a third and more, at the crests).
    void take_out(float* phase_px, float* amplitude, float period, std::size_t n) const;

private:
    double share_ = 0;
    std::vector<float> turns_, certainty_;  ///< to be added and multiplied, by thrice the phase
};

/// r, measured in the pictures of three shifts: the amplitude by (white - black) goes up and down with thrice the phase
/// as |e^ix + r e^-2ix| does, whatever curve projector and camera have. Empty where too little is lit to tell.
std::optional<double> measure_second_harmonic(const std::array<const std::uint8_t*, 3>& shifts,
                                              const std::uint8_t* white, const std::uint8_t* black, std::size_t pixels);

/// Of one camera's frames, in the order of `stripe_sequence(stripes)`: the largest r (by size) of its fringes of three
/// shifts; 0 where there are none, empty where one of them could not be measured.
std::optional<double> largest_second_harmonic(std::span<const GrayImage> frames, const StripeSettings& stripes);

}  // namespace planlight
