#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "registration/scan/pattern/stripe_patterns.h"

// What the checks of a sequence look at, gathered once from all frames of a camera. Private to registration/scan.
namespace planlight::sequence {

inline constexpr int kLit_grey = 16;         // white - black of a pixel to look at
inline constexpr int kBright_grey = 250;     // above it a sum says nothing
inline constexpr int kFlat_px = 3;           // how far the neighbours of a pixel are that are looked at with it
inline constexpr double kNoise_grey = 2;     // of one frame at least; what else is allowed goes with the contrast
inline constexpr std::size_t kEnough = 200;  // pixels, to say anything

/// The frames of one direction, by place in the sequence.
struct Direction {
    std::vector<std::size_t> gray, inverse, phase;
    std::vector<std::vector<std::size_t>> further;  ///< fringes of the further frequencies
    std::size_t wide = 0;  ///< so many of the coarsest bits have stripes wide enough for the camera (`wide_bits`)

    std::vector<std::size_t>& fringes(int frequency) {
        return frequency == 0 ? phase : further[static_cast<std::size_t>(frequency - 1)];
    }
};

using Bytes = std::vector<std::uint8_t>;

/// A sample of a camera's lit pixels in all frames, one list a frame.
struct Samples {
    std::vector<StripePattern> patterns;
    StripeSettings stripes;
    std::size_t white = 0, black = 1;  ///< frames
    std::array<Direction, 2> directions;

    double noise_grey = kNoise_grey,
           dark_noise_grey = 0;    ///< one sigma, as measured where there is light and where not
    int least_change = kLit_grey;  ///< more is light
    std::size_t changing = 0, not_white = 0,
                not_black = 0;   ///< pixels in which any light changes; white (black) is not the end
    std::size_t dark_white = 0;  ///< of not_white: nearly as dark as the darkest frame
    std::size_t lit = 0;         ///< pixels kept: white and black are the ends, and apart
    std::vector<Bytes> here;     ///< per frame
    /// The same kFlat_px to the left, right, above and below; empty for the frames of fringes.
    std::vector<std::array<Bytes, 4>> around;
    std::vector<std::int16_t> contrast, contrast_right, contrast_below;  ///< white - black

    /// How clearly a bit is set (above 0) or not, against its inverse or the middle of white and black: `at` gives the
    /// value of a frame.
    template <class At>
    int difference(const Direction& direction, std::size_t bit, const At& at) const {
        if (!direction.inverse.empty()) return at(direction.gray[bit]) - at(direction.inverse[bit]);
        return 2 * at(direction.gray[bit]) - at(white) - at(black);
    }
    const std::string& name(std::size_t frame) const { return patterns[frame].name; }
};

/// `patterns`: what the frames are, in their order. Throws std::invalid_argument when number or sizes of the frames do
/// not fit, or white or black is not among them.
Samples gather_samples(std::span<const GrayImage> frames, const StripeSettings& stripes,
                       std::vector<StripePattern> patterns);

/// 0 when `all` is 0.
inline double share_of(std::size_t part, std::size_t all) {
    return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
}

}  // namespace planlight::sequence
