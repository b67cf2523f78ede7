#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "segmentation/segment_skin.h"

namespace planlight {

/// The field whose crossing of `threshold` is the skin: the volume's own values where body meets air, so that the
/// crossing stays where the scanner saw it; filled cavities raised, removed objects lowered; one voxel of padding on
/// every side that puts the crossing half a voxel beyond the last voxel centres. No value equals the threshold.
struct SkinField {
    std::array<int, 3> size{0, 0, 0};  ///< of the volume plus two; field voxel (i,j,k) is volume voxel (i-1,j-1,k-1)
    std::vector<float> values;
    float threshold = 0;

    float at(int i, int j, int k) const {
        return values[(static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
                          static_cast<std::size_t>(size[0]) +
                      static_cast<std::size_t>(i)];
    }
};

/// Of the whole volume, on its own grid.
SkinField skin_field(const Volume& volume, const SkinMask& mask);

/// What the crossing on a grid edge of the field is: real skin, a lid, or the end of the volume. `a` and `b` are the
/// edge's ends in field voxels.
std::uint8_t flag_of_edge(const Volume& volume, const SkinMask& mask, const Eigen::Vector3i& a,
                          const Eigen::Vector3i& b);

/// Gradient of the field at a position in field voxels, per voxel: central differences, trilinear between voxels.
Eigen::Vector3d gradient(const SkinField& field, const Eigen::Vector3d& at);

}  // namespace planlight
