#pragma once

#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Fewer triangles, by half-edge collapses: the vertices that stay are where they were, with their normals and flags.
///
/// No point of the given surface is further than `max_error_mm` from the result: every vertex carries a bound on the error
/// of the triangles round it, and a collapse adds the distance of the removed vertex from the triangles that replace its own.
/// Vertices of different flags are never merged; no new edge is longer than `max_edge_mm`.
/// Throws std::runtime_error when the mesh is not a manifold.
TriangleMesh decimate_skin(const TriangleMesh& mesh, double max_edge_mm, double max_error_mm);

}  // namespace planlight
