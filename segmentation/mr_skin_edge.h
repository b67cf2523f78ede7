#pragma once

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// How far the skin may be moved to its edge.
struct EdgeSettings {
    double reach_mm = 3;     ///< an edge further than this from the vertex is another one
    int profile_rounds = 0;  ///< of means of the profiles over neighbours: takes noise away along the skin, not across
    int smoothing_rounds = 8;  ///< of the moves, over neighbours: the noise of a profile is not the skin's
};

/// Moves the skin's vertices along their normals to the outermost place where the volume's own profile is half way
/// between the air outside and what lies 1.5 to 2 mm deeper, by the size of the voxels (the search along rays of BET2's
/// outer skin, Jenkinson et al. 2005, but not to the crest beneath, which is the fat's). The coils of an MR scanner
/// make one side of a head several times as bright as the other; one threshold for all lies outside the edge there and
/// inside it here. Lids and cut planes stay. Values that are not finite are never used.
///
/// `values` are `leveled_values`, `threshold` what made the mesh. Returns how many vertices had an edge; the others
/// move with their neighbours.
std::size_t move_to_edges(TriangleMesh& mesh, const Volume& values, double threshold,
                          const EdgeSettings& settings = {});

}  // namespace planlight
