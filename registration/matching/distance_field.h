#pragma once

#include <Eigen/Core>

#include "planning_io/types/skin_lut.h"
#include "registration/matching/match_kernels.h"

namespace planlight {

/// The signed distance field of a table as plain arrays, for the inner loops of the matching.
/// The table must outlive it.
class DistanceField {
public:
    explicit DistanceField(const SkinLut& lut)
        : values_(lut.distance_mm.data()),
          size_(lut.distance_size[0], lut.distance_size[1], lut.distance_size[2]),
          stride_y_(size_.x()),
          stride_z_(static_cast<std::ptrdiff_t>(size_.x()) * size_.y()),
          per_mm_(1 / lut.distance_voxel_mm),
          origin_in_ct_(lut.origin_in_ct) {}

    /// Distance (mm, negative inside) and gradient (unit on average), trilinear. False outside the field.
    bool sample(const Eigen::Vector3d& p_in_ct, double& distance_mm, Eigen::Vector3d& gradient) const {
        const Eigen::Vector3d v = (p_in_ct - origin_in_ct_) * per_mm_;
        if (!(v.minCoeff() >= 0) || v.x() >= size_.x() - 1 || v.y() >= size_.y() - 1 || v.z() >= size_.z() - 1)
            return false;
        const Eigen::Vector3i c = v.cast<int>();
        const double fx = v.x() - c.x(), fy = v.y() - c.y(), fz = v.z() - c.z();
        const float* at = values_ + c.x() + c.y() * stride_y_ + c.z() * stride_z_;
        const float* up = at + stride_z_;
        // Along x first: four edges, their values and slopes.
        const double s00 = at[1] - at[0], s10 = at[stride_y_ + 1] - at[stride_y_];
        const double s01 = up[1] - up[0], s11 = up[stride_y_ + 1] - up[stride_y_];
        const double e00 = at[0] + fx * s00, e10 = at[stride_y_] + fx * s10;
        const double e01 = up[0] + fx * s01, e11 = up[stride_y_] + fx * s11;
        const double low = e00 + fy * (e10 - e00), high = e01 + fy * (e11 - e01);
        distance_mm = low + fz * (high - low);
        gradient = per_mm_ * Eigen::Vector3d((1 - fz) * ((1 - fy) * s00 + fy * s10) + fz * ((1 - fy) * s01 + fy * s11),
                                             (1 - fz) * (e10 - e00) + fz * (e11 - e01), high - low);
        return true;
    }

    /// The same field for the kernels; its first node lies at `origin_in_ct()`.
    match_kernels::Field plain() const {
        return {values_,
                static_cast<int>(stride_y_),
                static_cast<int>(stride_z_),
                static_cast<float>(size_.x() - 1),
                static_cast<float>(size_.y() - 1),
                static_cast<float>(size_.z() - 1),
                static_cast<float>(per_mm_)};
    }
    const Eigen::Vector3d& origin_in_ct() const { return origin_in_ct_; }

private:
    const float* values_;
    Eigen::Vector3i size_;
    std::ptrdiff_t stride_y_, stride_z_;
    double per_mm_;
    Eigen::Vector3d origin_in_ct_;
};

}  // namespace planlight
