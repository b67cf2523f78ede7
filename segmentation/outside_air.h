#pragma once

#include "segmentation/voxel_morphology.h"

namespace planlight {

/// The air round the body: flooded from the sides of the volume through what `solid` leaves free.
///
/// On each face of the volume only air that reaches the rim of that face is outside: a throat that the last slice cuts
/// is not a way in.
Mask outside_air(const Mask& solid, const VoxelGrid& grid);

/// The air round `body` when openings narrower than twice `seal_radius_mm` are closed by lids.
///
/// A closing by a ball alone would also fill creases beside the nose and behind the ears; the air takes back what lies
/// within half the seal radius of it, so that a lid sits at most that deep and a crease of 90 degrees stays sharp; and
/// it takes back whole pockets that end within the seal radius behind that: the folds of an ear are skin, not openings.
Mask outside_air_sealed(const Mask& body, const VoxelGrid& grid, double seal_radius_mm);

}  // namespace planlight
