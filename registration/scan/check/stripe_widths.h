#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "registration/scan/check/sequence_samples.h"

// Which bits of a Gray code the camera can resolve. Private to registration/scan.
namespace planlight::sequence {

/// How often a bit changes clearly between the lit samples and their neighbours kFlat_px to the right (0) and below
/// (1).
struct Changes {
    std::array<std::size_t, 2> changed{}, looked{};
    bool clear = false;  ///< most samples show it lit or dark without doubt; a bit too fine for the optics changes
                         ///< where noise will

    std::size_t all() const { return changed[0] + changed[1]; }
    double share() const;  ///< along the side on which it changes more often
};

/// Of every bit, coarsest first.
std::vector<Changes> changes_of(const Samples& samples, const Direction& direction);

/// How many bits, from the coarsest on, have stripes that are wide enough (6 pixels) to be looked at from pixel to
/// pixel. Each bit of a Gray code has twice the edges of the one before; what most bits say about the finest cell
/// decides, not a bit itself: stripes of 1.5 pixels look, every third pixel, like no stripes at all, and those of 3
/// like ones that change everywhere.
std::size_t wide_bits(const std::vector<Changes>& changes);

}  // namespace planlight::sequence
