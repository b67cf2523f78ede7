#pragma once

#include "planning_io/types/skin_lut.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Fills `lut.skin` with the voxels that the triangles pass through (exact triangle-box overlap), in the order of the
/// table (z, then y, then x). Size, voxel and origin must be set; on all cores.
///
/// Behind a voxel lies the point of those triangles that is nearest to its centre, the normal and the thickness between
/// those of the corners, and the flags of the triangle (those of all its corners).
void mark_skin_voxels(const TriangleMesh& skin, SkinLut& lut);

}  // namespace planlight
