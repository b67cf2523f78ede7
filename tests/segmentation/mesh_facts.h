#pragma once

#include "planning_io/types/triangle_mesh.h"

namespace planlight::test {

struct MeshFacts {
    std::size_t bad_edges = 0;  ///< not used exactly once in each direction: an opening, a fin or a flipped triangle
    std::size_t pieces = 0;
    long euler = 0;        ///< 2 for a closed surface without handles
    double volume_ml = 0;  ///< positive when the triangles turn outwards
    double longest_edge_mm = 0;
    double least_normal_dot = 1;  ///< vertex normals against the triangles round them
};

MeshFacts facts_of(const TriangleMesh& mesh);

}  // namespace planlight::test
