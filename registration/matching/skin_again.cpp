#include "registration/matching/skin_again.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "planning_io/types/statistics.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// The cells of the match's places, as `measure_displacement` gathered them: not those beside them, where cloth may lie
/// that takes more points than the skin.
class Places {
public:
    explicit Places(const SkinDisplacement& found) : everywhere_(!found.known()), cell_mm_(found.apart_mm) {
        for (const auto& place : found.places) cells_.insert(cell_of(place.p_in_ct));
    }
    bool holds(const Vector3d& p_in_ct) const { return everywhere_ || cells_.contains(cell_of(p_in_ct)); }

private:
    std::array<int, 3> cell_of(const Vector3d& p_in_ct) const {
        const Eigen::Vector3i at = (p_in_ct / cell_mm_).array().floor().cast<int>();
        return {at.x(), at.y(), at.z()};
    }
    bool everywhere_;
    double cell_mm_;
    std::set<std::array<int, 3>> cells_;
};

}  // namespace

SkinAgain skin_again(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                     const SkinDisplacement& found, double skin_offset_mm) {
    constexpr double kNear_mm = 10, kFacingCosine = 0.5;
    const bool has_normals = cloud.normals_in_rig.size() == cloud.size();
    const Places places(found);
    SkinAgain again;
    std::vector<double> off_mm;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (!cloud.points_in_rig[i].allFinite()) continue;
        const Vector3d p = ct_from_rig * cloud.points_in_rig[i];
        const SkinPoint* skin = lut.nearest_skin(p);
        if (!skin || skin->flags != kSkin) continue;
        const Vector3d normal = skin->normal_in_ct.cast<double>(), foot = skin->position_in_ct.cast<double>();
        if (has_normals && !((ct_from_rig.linear() * cloud.normals_in_rig[i]).dot(normal) > kFacingCosine)) continue;
        if (!((p - foot).norm() < kNear_mm) || !places.holds(p - (p - foot).dot(normal) * normal)) continue;
        again.cloud.points_in_rig.push_back(cloud.points_in_rig[i]);
        if (has_normals) again.cloud.normals_in_rig.push_back(cloud.normals_in_rig[i]);
        off_mm.push_back((p - foot).dot(normal) - skin_offset_mm);
    }
    constexpr double kOn_skin_mm = 1;
    const auto share = [&](const auto& fact) {
        const auto count = std::count_if(off_mm.begin(), off_mm.end(), fact);
        return off_mm.empty() ? 0 : static_cast<double>(count) / static_cast<double>(off_mm.size());
    };
    again.near_share = share([](double mm) { return std::abs(mm) <= kOn_skin_mm; });
    again.inside_share = share([](double mm) { return mm < -kOn_skin_mm; });
    for (double& mm : off_mm) mm = std::abs(mm);
    again.median_mm = median(std::move(off_mm));
    return again;
}

}  // namespace planlight
