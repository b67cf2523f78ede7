#pragma once

#include "planning_io/types/volume.h"

namespace planlight::test {

/// A CT of the analytic head in 2 mm voxels: -300 HU is its surface to about 0.05 mm, because the values fall linearly
/// with the distance there. With `plates`, two bright slabs stand beside the head, as those of a head holder.
Volume volume_of_analytic_head(bool plates = false);

}  // namespace planlight::test
