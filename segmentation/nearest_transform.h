#pragma once

#include "planning_io/types/skin_lut.h"

namespace planlight {

/// Which instructions the transform uses. All give the same table, bit for bit.
enum class VectorPath { best, avx512, avx2, plain };

/// Whether this processor has them. `best` and `plain` always.
bool can_use(VectorPath path);

/// Points every voxel of `lut.nearest` to its nearest skin voxel, exact in the Euclidean distance of voxel centres;
/// among several equally near ones to the first in `lut.skin`.
///
/// Given: `lut.size` and `lut.skin`, not empty and sorted in the order of the table (z, then y, then x). Separable
/// exact transform that carries the index (Meijster 2000; Felzenszwalb & Huttenlocher 2012), integers throughout, on
/// all cores. Throws std::logic_error when the skin is not sorted or the path cannot be used.
void point_to_nearest(SkinLut& lut, VectorPath path = VectorPath::best);

}  // namespace planlight
