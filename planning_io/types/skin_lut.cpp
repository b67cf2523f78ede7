#include "planning_io/types/skin_lut.h"

#include <cmath>

namespace planlight {

const SkinPoint* SkinLut::nearest_skin(const Eigen::Vector3d& p_in_ct) const {
    const Eigen::Vector3d voxel = (p_in_ct - origin_in_ct) / voxel_mm;
    if (!voxel.allFinite()) return nullptr;
    std::size_t index = 0;
    for (int axis = 2; axis >= 0; --axis) {
        const double rounded = std::floor(voxel[axis] + 0.5);
        if (rounded < 0 || rounded >= size[static_cast<std::size_t>(axis)]) return nullptr;
        index =
            index * static_cast<std::size_t>(size[static_cast<std::size_t>(axis)]) + static_cast<std::size_t>(rounded);
    }
    return &skin[nearest[index]];
}

std::optional<SkinLut::Distance> SkinLut::signed_distance(const Eigen::Vector3d& p_in_ct) const {
    const Eigen::Vector3d g = (p_in_ct - origin_in_ct) / distance_voxel_mm;
    if (!(g.minCoeff() >= 0) || !(g.x() < distance_size[0] - 1) || !(g.y() < distance_size[1] - 1) ||
        !(g.z() < distance_size[2] - 1))
        return std::nullopt;
    const Eigen::Vector3i cell = g.cast<int>();
    const Eigen::Vector3d f = g - cell.cast<double>();
    const auto row = static_cast<std::size_t>(distance_size[0]);
    const auto slab = row * static_cast<std::size_t>(distance_size[1]);
    const float* corner = distance_mm.data() + static_cast<std::size_t>(cell.z()) * slab +
                          static_cast<std::size_t>(cell.y()) * row + static_cast<std::size_t>(cell.x());
    const double c000 = corner[0], c100 = corner[1], c010 = corner[row], c110 = corner[row + 1];
    const double c001 = corner[slab], c101 = corner[slab + 1], c011 = corner[slab + row], c111 = corner[slab + row + 1];
    const double x00 = c000 + f.x() * (c100 - c000), x10 = c010 + f.x() * (c110 - c010);
    const double x01 = c001 + f.x() * (c101 - c001), x11 = c011 + f.x() * (c111 - c011);
    const double y0 = x00 + f.y() * (x10 - x00), y1 = x01 + f.y() * (x11 - x01);
    const double dx = (1 - f.z()) * ((1 - f.y()) * (c100 - c000) + f.y() * (c110 - c010)) +
                      f.z() * ((1 - f.y()) * (c101 - c001) + f.y() * (c111 - c011));
    const double dy = (1 - f.z()) * (x10 - x00) + f.z() * (x11 - x01);
    return Distance{y0 + f.z() * (y1 - y0), Eigen::Vector3d(dx, dy, y1 - y0) / distance_voxel_mm};
}

}  // namespace planlight
