#pragma once

#include <Eigen/Geometry>
#include <array>

#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Along the outward normal of the triangle (three vertices of `mesh`), in ct; its length is the area, square mm.
inline Eigen::Vector3d area_in_ct(const TriangleMesh& mesh, const std::array<std::int32_t, 3>& triangle) {
    const auto corner = [&](std::size_t k) -> const Eigen::Vector3d& {
        return mesh.vertices_in_ct[static_cast<std::size_t>(triangle[k])];
    };
    return (corner(1) - corner(0)).cross(corner(2) - corner(0)) / 2;
}

}  // namespace planlight
