#pragma once

#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Fewer triangles, by half-edge collapses: the vertices that stay are where they were, with their normals and flags.
///
/// The two surfaces are nowhere further apart than `max_error_mm`, both ways: each point has a partner on the other
/// within it. Every vertex carries what is proven for the triangles round it, a collapse adds its own bound
/// (collapse_bound.h), and one that would exceed `max_error_mm`, or for which nothing can be proven, is not made.
/// Vertices of different flags are never merged; no new edge is longer than `max_edge_mm`.
/// Throws std::runtime_error when the mesh is not a manifold.
TriangleMesh decimate_skin(const TriangleMesh& mesh, double max_edge_mm, double max_error_mm);

}  // namespace planlight
