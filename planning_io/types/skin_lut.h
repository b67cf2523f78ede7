#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/large_array.h"

namespace planlight {

/// A voxel of the table that the skin passes through, and what lies behind a pointer to it.
struct SkinPoint {
    Eigen::Vector3f position_in_ct;  ///< the sub-voxel skin point, mm
    Eigen::Vector3f normal_in_ct;    ///< unit, outwards
    std::array<std::uint16_t, 3> voxel{0, 0, 0};
    std::uint8_t flags = 0;                                        ///< SkinFlag
    float thickness_mm = std::numeric_limits<float>::quiet_NaN();  ///< from skin to bone; not a number where unknown
};

/// The paper's voxel file (Hoppe 2001, 2.1): cubic voxels over the body and a margin, each with a pointer to its
/// nearest skin voxel; beside it a signed distance field for the matching.
///
/// Voxel (i,j,k) has its centre at `origin_in_ct + voxel_mm * (i,j,k)`; axes are those of ct; i runs fastest.
/// The distance field has its own, coarser grid from the same origin; negative inside the body.
struct SkinLut {
    std::array<int, 3> size{0, 0, 0};
    double voxel_mm = 0;
    Eigen::Vector3d origin_in_ct = Eigen::Vector3d::Zero();
    LargeArray<std::uint32_t> nearest;  ///< per voxel: index into `skin`
    std::vector<SkinPoint> skin;

    std::array<int, 3> distance_size{0, 0, 0};
    double distance_voxel_mm = 0;
    LargeArray<float> distance_mm;  ///< signed, to the surface; negative inside

    std::string volume_hash;  ///< of the CT the table was made from (hex)
    std::string mesh_hash;    ///< of the skin mesh (hex)

    /// The skin voxel nearest to a ct point: the closest-point table of the ICP. Null outside the table.
    const SkinPoint* nearest_skin(const Eigen::Vector3d& p_in_ct) const;

    /// Signed distance to the skin, mm, trilinear, and its gradient (unit on average). Empty outside the field.
    struct Distance {
        double mm;
        Eigen::Vector3d gradient;
    };
    std::optional<Distance> signed_distance(const Eigen::Vector3d& p_in_ct) const;
};

}  // namespace planlight
