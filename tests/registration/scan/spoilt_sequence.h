#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "registration/scan/check/check_sequence.h"
#include "tests/registration/scan/stripe_room.h"

// Captures with frames that are late, doubled, missing or exchanged, for the tests of the sequence check.
namespace planlight::spoilt_sequence {

/// A camera's frames of a sequence, without noise.
struct Sequence {
    StripeSettings stripes;
    std::vector<StripePattern> patterns;
    std::vector<GrayImage> frames;
};

/// The left camera's frames of the whole sequence of `stripes`.
Sequence sequence_of(const stripe_room::Room& room, const StripeSettings& stripes);

/// In the paper's room, of a surface that gets so much light of lamps and of the projector.
Sequence sequence_of(stripe_room::Surface surface, double ambient_grey, double white_grey = 190);

/// Of a Gray code without fringes whose cells are `cell_px` projector pixels.
Sequence gray_code_of(const stripe_room::Room& room, double cell_px, bool inverse);

std::vector<GrayImage> with_noise(std::vector<GrayImage> frames, double sigma, unsigned seed);

/// The share of the lit pixels at which two captures differ in any frame by more than a third of the contrast: where a
/// fault changes nothing there is nothing to notice.
double changed(const std::vector<GrayImage>& a, const std::vector<GrayImage>& b);

/// What a rig does to the frames from one on (late once, early once, late from there on, late by two, missing).
struct Fault {
    std::string what;  ///< e.g. "late_once at column-gray-3"
    std::vector<GrayImage> frames;
};
void each_timing_fault(const Sequence& sequence, const std::function<void(const Fault&)>& look);

/// Every two frames exchanged whose numbers are `first` and, any, greater.
void each_exchange(const Sequence& sequence, std::size_t first, const std::function<void(const Fault&)>& look);

std::string said(const SequenceCheck& check);

}  // namespace planlight::spoilt_sequence
