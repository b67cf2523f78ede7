#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace planlight {

/// What a vertex of the skin is not: real skin that light and registration may rely on.
enum SkinFlag : std::uint8_t {
    kSkin = 0,
    kSeal = 1,      ///< a lid over a nostril, ear canal or the mouth: made by closing, not seen in the CT
    kCutPlane = 2,  ///< the end of the volume
};

/// Triangles in the ct frame (LPS), mm, counter-clockwise seen from outside.
struct TriangleMesh {
    std::vector<Eigen::Vector3d> vertices_in_ct;
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::vector<Eigen::Vector3d> normals_in_ct;  ///< per vertex, unit, outwards; empty when not computed
    std::vector<std::uint8_t> flags;             ///< SkinFlag per vertex; empty means all kSkin
    /// Per vertex, from the skin inwards to bone; not a number where none was found. Empty when not computed.
    std::vector<float> thickness_mm;
};

}  // namespace planlight
