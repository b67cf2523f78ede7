#pragma once

#include <vector>

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// How deep the bone is looked for.
struct ThicknessSettings {
    double bone_hu = 300;
    double longest_mm = 40;  ///< further in nothing is looked for
};

/// How thick the soft tissue is over the bone: for each vertex the way along its inward normal to the first crossing of
/// `bone_hu` (trilinear between voxels), mm. Not a number where there is no bone within `longest_mm` or within the
/// volume, and on lids and cut planes. Skin that shifts is thick: where it is thin the skin is the bone's.
///
/// Empty when the volume is not a CT in HU, or the mesh has no normals. Metal counts as bone.
std::vector<float> skin_thickness(const Volume& volume, const TriangleMesh& skin,
                                  const ThicknessSettings& settings = {});

}  // namespace planlight
