#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <vector>

#include "planning_io/types/volume.h"

namespace planlight::simulation {

/// The CT as a continuous field: trilinear between the voxels, the head alone, air all round (so that its cut ends are
/// closed). The true skin is where it is zero.
class CtField {
public:
    /// Throws std::invalid_argument when no head is above the threshold.
    CtField(const Volume& volume, double threshold);

    /// Field minus threshold: positive inside the head.
    double above(const Eigen::Vector3d& p_in_ct) const { return sample(values_, voxel_from_ct_ * p_in_ct); }

    /// Gradient of `above` per mm, in ct.
    Eigen::Vector3d gradient(const Eigen::Vector3d& p_in_ct) const;

    /// As `gradient`, of the field smoothed over about a voxel: no facets in it. For directions, not for positions.
    Eigen::Vector3d smooth_gradient(const Eigen::Vector3d& p_in_ct) const;

    /// True when a voxel next to the point is air that is connected with the room.
    bool next_to_room_air(const Eigen::Vector3d& p_in_ct) const;

    const std::array<int, 3>& size() const { return size_; }
    const std::vector<float>& values() const { return values_; }
    /// Of the padded grid.
    const Eigen::Affine3d& ct_from_voxel() const { return ct_from_voxel_; }

private:
    double sample(const std::vector<float>& values, const Eigen::Vector3d& voxel) const;
    void smooth();
    void find_room_air();
    std::size_t index(int i, int j, int k) const {
        return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(size_[0]) +
               static_cast<std::size_t>(i);
    }

    std::array<int, 3> size_{};
    Eigen::Affine3d ct_from_voxel_, voxel_from_ct_;
    std::vector<float> values_, smoothed_;
    std::vector<std::uint8_t> room_air_;
    double air_ = 0;
};

/// Trilinear; `voxel` in voxels from the first centre.
inline double CtField::sample(const std::vector<float>& values, const Eigen::Vector3d& voxel) const {
    const double x = std::floor(voxel.x()), y = std::floor(voxel.y()), z = std::floor(voxel.z());
    if (!(x >= 0 && y >= 0 && z >= 0 && x < size_[0] - 1 && y < size_[1] - 1 && z < size_[2] - 1)) return air_;
    const float* v = values.data() + index(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z));
    const double a = voxel.x() - x, b = voxel.y() - y, c = voxel.z() - z;
    const auto row = static_cast<std::size_t>(size_[0]), slice = row * static_cast<std::size_t>(size_[1]);
    const auto along = [a](const float* p) {
        return static_cast<double>(p[0]) + a * (static_cast<double>(p[1]) - static_cast<double>(p[0]));
    };
    const double low = along(v) + b * (along(v + row) - along(v));
    const double high = along(v + slice) + b * (along(v + slice + row) - along(v + slice));
    return low + c * (high - low);
}

}  // namespace planlight::simulation
