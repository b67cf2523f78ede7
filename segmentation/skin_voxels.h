#pragma once

#include "planning_io/types/skin_lut.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Fills `lut.skin` with the voxels that the triangles pass through (exact triangle-box overlap), in the order of the table,
/// and marks them in `lut.nearest`; every other voxel of `nearest` becomes `kNoSkin`. Size, voxel and origin must be set.
///
/// Behind a voxel lies the point of those triangles that is nearest to its centre, the normal between the corners'
/// normals, and the flags of the triangle (those of all its corners).
void mark_skin_voxels(const TriangleMesh& skin, SkinLut& lut);

inline constexpr std::uint32_t kNoSkin = 0xFFFFFFFF;

}  // namespace planlight
