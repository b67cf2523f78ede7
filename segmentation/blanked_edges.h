#pragma once

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// Flags as an end of the scan (`kCutPlane`) where the head ends because values were blanked: at a round field of view,
/// a face that was taken away, the corners of a volume that was sliced anew. There tissue stands at full strength
/// beside voxels of one value, over whole patches; a skin's own edge is blurred over a voxel at least. Nothing is
/// flagged where the skin's edge looks so all over (a background that was set to one value). `mesh` has flags and
/// normals; `threshold` in the volume's unit.
void flag_blanked_edges(TriangleMesh& mesh, const Volume& volume, double threshold);

}  // namespace planlight
