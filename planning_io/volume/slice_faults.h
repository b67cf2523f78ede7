#pragma once

#include "planning_io/types/volume.h"

namespace planlight {

/// Notes in `volume.notes`, for any axis: slices that are there twice, bit for bit, and neighbours that differ 2.5
/// times as much as those around them, as where slices are missing: behind either the head is in the wrong place. Asked
/// where neighbours differ by noise nearly everywhere, as those of a scanner do. At the outer four slices nothing is
/// told.
void note_slice_faults(Volume& volume);

}  // namespace planlight
