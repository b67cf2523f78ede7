#pragma once

#include <functional>

#include "planning_io/types/skin_lut.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Edge and extent of the tables, mm.
struct LutSettings {
    double voxel_mm = 1;
    double margin_mm = 40;         ///< round the skin
    double distance_voxel_mm = 2;  ///< of the signed distance field
};

/// The paper's voxel table from the skin (Hoppe 2001, 2.1): every cubic voxel points to its nearest skin voxel, exact
/// in the Euclidean distance of voxel centres. The hashes are left empty: who writes the file knows them. Throws
/// InputError when the mesh is empty or the table would exceed 2 GiB (use larger voxels).
SkinLut build_skin_lut(const TriangleMesh& skin, const LutSettings& settings = {},
                       const std::function<void(double)>& progress = {});

}  // namespace planlight
