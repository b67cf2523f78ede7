#pragma once

namespace planlight {

/// Slices of a series that are not evenly spaced (4 mm through the skull's base, 7 mm above: usual in head CT):
/// refused, or laid onto an even grid of the smallest step, linear between the cuts where they really lie.
enum class SliceGaps { refused, resampled };

}  // namespace planlight
