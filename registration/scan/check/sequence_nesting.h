#pragma once

#include <span>

#include "registration/scan/check/check_sequence.h"
#include "registration/scan/check/sequence_samples.h"

// What the bits of a Gray code say about each other, without fringes or inverses to ask. Private to registration/scan.
namespace planlight::sequence {

/// Only one bit of a Gray code changes at a time; where it does, the next finer one is lit and those after it are dark
/// (F. Gray, US 2,632,058, 1953: the code is its own mirror image there). So late, doubled, missing and exchanged bits
/// are seen at the stripes' edges. And over a surface the code runs one way: a coarsest bit that is another picture
/// makes it turn back, one that is inverted makes it a mirror image. Bits that the camera does not resolve are left
/// alone.
void check_nesting(std::span<const GrayImage> frames, const Samples& samples, SequenceCheck& check);

}  // namespace planlight::sequence
