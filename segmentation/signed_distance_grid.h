#pragma once

#include "planning_io/types/skin_lut.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Fills the table's distance field: within `kExactBand_mm` of the skin the exact distance to the triangles, signed by
/// the angle-weighted pseudonormal of the nearest face, edge or corner (Baerentzen & Aanaes 2005); beyond it the
/// distance to the point behind the pointer. The table itself must be complete.
void fill_signed_distance(const TriangleMesh& skin, SkinLut& lut);

/// Nearer than this to the skin the distance is exact.
inline constexpr double kExactBand_mm = 5;

}  // namespace planlight
