#pragma once

#include <optional>

#include "registration/tracking/ellipse.h"
#include "registration/tracking/find_markers.h"

namespace planlight {

/// A marker's disc measured from a rough place: rays to its edge, an ellipse through them, then the dual conic of the
/// gradients. Empty when what is there is no disc on a bright ring: the edge must be closed, the inside dark, the ring
/// bright all round and brighter than what surrounds the sticker.
///
/// `rough` may be off by about half a radius, and be a circle where the disc is a strongly tilted ellipse.
std::optional<MarkerObservation> measure_disc(const GrayImage& picture, const Ellipse& rough,
                                              const MarkerSettings& settings);

}  // namespace planlight
