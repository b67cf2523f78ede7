#pragma once

#include "planning_io/types/skin_lut.h"

namespace planlight {

/// Points every voxel of `lut.nearest` to its nearest skin voxel, exact in the Euclidean distance of voxel centres.
///
/// Given: `lut.skin` sorted in the order of the table and marked in `lut.nearest`, kNoSkin elsewhere. Separable exact
/// transform that carries the index (Felzenszwalb & Huttenlocher 2012; Meijster 2000), integers throughout, on all cores.
void point_to_nearest(SkinLut& lut);

}  // namespace planlight
