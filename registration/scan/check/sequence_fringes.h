#pragma once

#include <optional>
#include <string>
#include <vector>

#include "registration/scan/check/check_sequence.h"
#include "registration/scan/check/sequence_samples.h"

// What the fringes of a sequence say about the order of its frames. Private to registration/scan.
namespace planlight::sequence {

/// Amplitude, phase and what is left over of the fringes at a pixel.
struct Fringe {
    float amplitude = 0, phase = 0;  ///< phase of the shift at the crest, radians
    float residual_grey = 0;         ///< rms by degree of freedom of what a fringe and its second harmonic cannot make
};

/// The fringes at all samples; empty where there are none.
std::vector<Fringe> fringes_of(const Samples& samples, const std::vector<std::size_t>& phases);

/// A fringe picture that stands in the place of the next one: over a whole fringe each differs from the one before it
/// as much as any other does. Finer than `check_fringes`, which asks pixel by pixel, where noise hides two of eight.
void check_doubled(const Samples& samples, const std::vector<std::size_t>& phases, const std::vector<Fringe>& fringes,
                   SequenceCheck& check);

/// Frames that no fringe and its gamma can make.
void check_fringes(const Samples& samples, const std::vector<std::size_t>& phases, const std::vector<Fringe>& fringes,
                   SequenceCheck& check);

/// A Gray code's number is odd where an odd number of its bits is set; the fringe says the same of its two halves.
void check_parity(const Samples& samples, const Direction& direction, const std::vector<Fringe>& fringes,
                  SequenceCheck& check);

/// How far the fringes lie beside the Gray code, projector pixels: where the code really changes, by the fringes' own
/// measure, as a mean over all borders of its finest stripes (blur and gamma are alike on both sides of one). Empty
/// without either, and where too little is seen near the borders.
std::optional<double> fringe_offset_px(const Samples& samples, const Direction& direction,
                                       const std::vector<Fringe>& fringes);

/// Fringes that begin with another shift than they should lie beside the code by a part of its stripe, which
/// `check_parity` does not see; believed, they move the light by as much.
void check_offset(const Samples& samples, const Direction& direction, const std::vector<Fringe>& fringes,
                  SequenceCheck& check);

/// Fringes of several frequencies must agree about a place.
void check_frequencies(const Samples& samples, const Direction& direction,
                       const std::vector<std::vector<Fringe>>& fringes, SequenceCheck& check);

/// Another frame that looks just like this one although its picture is another.
std::optional<std::size_t> twin_of(const Samples& samples, std::size_t frame);

/// "; A looks like B"; empty where there is none.
std::string explain(const Samples& samples, std::size_t frame);

}  // namespace planlight::sequence
