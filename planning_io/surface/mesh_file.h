#pragma once

#include <filesystem>
#include <string>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Binary PLY with "comment SPACE=LPS"; vertex normals, flags and thickness included.
void write_mesh(const TriangleMesh& mesh, const std::filesystem::path& file);

/// PLY as written above, or another program's PLY with SPACE=LPS or SPACE=RAS (converted); without a SPACE it is
/// refused.
TriangleMesh read_mesh(const std::filesystem::path& file);

/// Binary PLY of a scan in rig, with "comment FRAME=rig"; columns x y z nx ny nz sigma projector_x projector_y. With
/// `triangles` (indices of its points) they are its faces: the scan as a surface, which `read_cloud` takes too.
void write_cloud(const PointCloud& cloud, const std::filesystem::path& file,
                 const std::vector<std::array<std::int32_t, 3>>& triangles = {},
                 const std::vector<std::string>& comments = {});

/// What a person says of a cloud that another program wrote.
struct CloudOrigin {
    double unit_mm = 1;   ///< of its numbers, in mm: 1000 for metres
    bool in_rig = false;  ///< its points are in the rig's frame though it does not say so
};
/// Points of the file that are none of the scan's: what some scanners write for what they did not measure.
struct PointsLeftOut {
    std::size_t at_origin = 0;       ///< exactly there
    std::size_t repeated = 0;        ///< exactly where another one is
    std::size_t without_normal = 0;  ///< of zero length or not finite, where most others have one
    std::size_t all() const { return at_origin + repeated + without_normal; }
};
/// Throws InputError for a cloud that is not said to be in the rig's frame, DamagedFileError for a damaged one. Normals
/// are read where they are (`nx ny nz`) and brought to unit length; there are none where most of the points have none.
/// Sigma and projector pixels are read as well. `comments`: those of its header.
PointCloud read_cloud(const std::filesystem::path& file, const CloudOrigin& origin = {},
                      std::vector<std::string>* comments = nullptr, PointsLeftOut* left_out = nullptr);

/// XXH3-128 of vertices and triangles, hex.
std::string hash_of(const TriangleMesh& mesh);

}  // namespace planlight
