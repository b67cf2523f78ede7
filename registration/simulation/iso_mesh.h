#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "registration/simulation/ct_field.h"

namespace planlight::simulation {

/// The surface where the field is zero, as fine as its voxels; only what faces the air of the room.
struct IsoMesh {
    std::vector<Eigen::Vector3f> vertices_in_ct;
    std::vector<Eigen::Vector3f> normals_in_ct;  ///< outwards, from the smoothed field
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

IsoMesh iso_mesh(const CtField& field);

}  // namespace planlight::simulation
