#include "registration/matching/coarse_distance.h"

#include <algorithm>
#include <cmath>

#include "planning_io/types/triangle_mesh.h"
#include "registration/matching/distance_field.h"

namespace planlight {
namespace {

constexpr double kCell_mm = 4;

}  // namespace

CoarseDistance::CoarseDistance(const SkinLut& lut, double truncation_mm, double truncation_outside_mm)
    : origin_in_ct_(lut.origin_in_ct.cast<float>()), mm_per_step_(static_cast<float>(truncation_mm / 255)) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        size_[axis] = std::max(1, static_cast<int>((lut.distance_size[a] - 1) * lut.distance_voxel_mm / kCell_mm));
    }
    const DistanceField field(lut);
    steps_.reserve(static_cast<std::size_t>(size_.prod()));
    for (int k = 0; k < size_.z(); ++k)
        for (int j = 0; j < size_.y(); ++j)
            for (int i = 0; i < size_.x(); ++i) {
                const Eigen::Vector3d centre = lut.origin_in_ct + kCell_mm * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
                double d = truncation_mm;
                Eigen::Vector3d unused;
                if (field.sample(centre, d, unused))
                    d = d > 0 ? std::min(d, truncation_outside_mm) : std::min(-d, truncation_mm);
                if (d < truncation_mm / 3) {
                    const SkinPoint* s = lut.nearest_skin(centre);
                    if (s && s->flags & kCutPlane) d = truncation_mm / 3;
                }
                steps_.push_back(static_cast<std::uint8_t>(std::lround(255 * d / truncation_mm)));
            }
}

float CoarseDistance::sum(std::span<const Eigen::Vector3f> points_in_rig, const Eigen::Matrix3f& R,
                          const Eigen::Vector3f& t, float limit_mm) const {
    constexpr float kPerMm = static_cast<float>(1 / kCell_mm);
    constexpr std::size_t kBlock = 8;
    const Eigen::Matrix3f A = kPerMm * R;
    const Eigen::Vector3f b = kPerMm * (t - origin_in_ct_);
    const float limit = limit_mm / mm_per_step_;
    float total = 0;
    for (std::size_t first = 0; first < points_in_rig.size() && total <= limit; first += kBlock) {
        const std::size_t last = std::min(first + kBlock, points_in_rig.size());
        for (std::size_t i = first; i < last; ++i) {
            const Eigen::Vector3f& p = points_in_rig[i];
            const float x = A(0, 0) * p.x() + A(0, 1) * p.y() + A(0, 2) * p.z() + b.x();
            const float y = A(1, 0) * p.x() + A(1, 1) * p.y() + A(1, 2) * p.z() + b.y();
            const float z = A(2, 0) * p.x() + A(2, 1) * p.y() + A(2, 2) * p.z() + b.z();
            const bool inside = x >= 0 && y >= 0 && z >= 0 && x < static_cast<float>(size_.x()) &&
                                y < static_cast<float>(size_.y()) && z < static_cast<float>(size_.z());
            total +=
                inside
                    ? static_cast<float>(steps_[static_cast<std::size_t>(
                          (static_cast<int>(z) * size_.y() + static_cast<int>(y)) * size_.x() + static_cast<int>(x))])
                    : 255.f;
        }
    }
    return total * mm_per_step_;
}

}  // namespace planlight
