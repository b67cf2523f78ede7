#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "registration/scan/pattern/stripe_patterns.h"

namespace planlight {

/// A frame that cannot show the picture it stands for.
struct SequenceProblem {
    std::size_t frame = 0;  ///< in the order of the sequence
    std::string
        what;  ///< with the names of the pictures, e.g. "column-gray-2 and its inverse do not complete each other"
    double share = 0;  ///< of the pixels looked at
    /// What it most likely comes from: pictures at the wrong time, or under each other's names; light or exposure that
    /// changed (or a picture at the wrong time); lamps that flicker; inverted or mirrored pictures; fringes that are
    /// not those of capture.json.
    enum class Cause { timing, order, light, flicker, mirrored, fringes } cause = Cause::timing;
};

/// A sentence on what to look for, by the cause.
std::string remedy_of(const SequenceProblem& problem);

/// Whether every frame of one camera shows its own picture, judged by what the lit pixels must have in common.
struct SequenceCheck {
    std::size_t pixels = 0;                 ///< looked at
    bool checked = false;                   ///< false: too few lit pixels to say anything
    std::vector<SequenceProblem> problems;  ///< empty: as it should be
};

/// Looks for late, doubled, missing, swapped and inverted frames. No frame number is needed in the pictures, so
/// captures of others are checked as well, and it works wherever skin is lit: white is the brightest frame and black
/// the darkest; a Gray picture and its inverse add up to white and black; fringes have no share that the fringe and its
/// gamma cannot make; the parity of the Gray code is that of the fringe's half; of two bits the finer one changes more
/// often; fringes of several frequencies agree about the place. A Gray code without fringes or without inverses is
/// judged by what its bits do at each other's edges (`check_nesting`). Not noticed: with fringes and inverses two whole
/// bits swapped where they change fewer than four times over the lit surface (the views then disagree about the place),
/// and what makes no difference there (a doubled picture that looks the same). Throws std::invalid_argument when number
/// or sizes of the frames do not fit.
SequenceCheck check_sequence(std::span<const GrayImage> frames, const StripeSettings& stripes);

/// The same for a capture that is not all of the sequence (no fringes, bits missing at the fine end): `patterns` says
/// what the frames are, in their order. What cannot be judged without the missing ones is not. `patchy`: a board, whose
/// dark squares hide the edges of one bit and not of another, so that how often they change is not judged.
SequenceCheck check_sequence(std::span<const GrayImage> frames, const StripeSettings& stripes,
                             const std::vector<StripePattern>& patterns, bool patchy = false);

}  // namespace planlight
