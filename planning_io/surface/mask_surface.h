#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Voxels that somebody marked as inside (1) or outside (0); i runs fastest, voxel centres at `ct_from_voxel * (i, j,
/// k)`.
struct MaskStack {
    std::array<int, 3> size{0, 0, 0};
    Eigen::Affine3d ct_from_voxel = Eigen::Affine3d::Identity();
    std::vector<std::uint8_t> inside;
};

/// The half-way surface of the mask smoothed by (1 2 1)/4 along each axis: closed, flat faces where they were, the
/// steps of the voxels rounded off; what is one voxel thin is lost. Vertices and triangles only; empty when nothing is
/// marked.
TriangleMesh surface_of_mask(const MaskStack& mask);

}  // namespace planlight
