#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Which side of a mesh a point is on, whatever its nearest feature: the angle-weighted pseudonormals of faces, edges
/// and corners (Baerentzen & Aanaes 2005).
class MeshSides {
public:
    explicit MeshSides(const TriangleMesh& mesh);

    const Eigen::Vector3d& face_normal(std::size_t triangle) const { return face_normals_[triangle]; }  ///< unit

    /// Pseudonormal, not of unit length, of the feature that a closest point with these corner weights lies on.
    Eigen::Vector3d normal_at(std::size_t triangle, const Eigen::Vector3d& weights) const;

private:
    void find_neighbours();

    const TriangleMesh& mesh_;
    std::vector<Eigen::Vector3d> face_normals_, corner_normals_;  // of each triangle, of each vertex
    std::vector<std::array<std::uint32_t, 3>>
        neighbours_;  // across the edge opposite to each corner; itself at an opening
};

}  // namespace planlight
