#pragma once

#include <optional>

#include "planning_io/types/volume.h"

namespace planlight {

/// The volume's value at a position in voxels, trilinear; empty outside the voxel centres.
inline std::optional<double> value_at(const Volume& volume, const Eigen::Vector3d& voxel) {
    const Eigen::Vector3i low = voxel.array().floor().cast<int>();
    for (int a = 0; a < 3; ++a)
        if (low[a] < 0 || low[a] + 1 >= volume.size[static_cast<std::size_t>(a)]) return std::nullopt;
    const Eigen::Vector3d f = voxel - low.cast<double>();
    const std::size_t row = static_cast<std::size_t>(volume.size[0]),
                      slab = row * static_cast<std::size_t>(volume.size[1]);
    const float* at = volume.values.data() + volume.index(low.x(), low.y(), low.z());
    const auto along_x = [&](std::size_t from) {
        return (1 - f.x()) * static_cast<double>(at[from]) + f.x() * static_cast<double>(at[from + 1]);
    };
    const double front = (1 - f.y()) * along_x(0) + f.y() * along_x(row),
                 back = (1 - f.y()) * along_x(slab) + f.y() * along_x(slab + row);
    return (1 - f.z()) * front + f.z() * back;
}

}  // namespace planlight
