#include "registration/matching/scan_places.h"

#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

using Eigen::Vector3d;

std::vector<Foot> feet_of(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                          double facing_cosine, double most_inside_mm, double most_outside_mm) {
    constexpr std::size_t kMostPoints = 100000;
    std::vector<Foot> feet;
    const std::size_t stride = std::max<std::size_t>(1, cloud.size() / kMostPoints);
    const bool has_normals = cloud.normals_in_rig.size() == cloud.size();
    for (std::size_t i = 0; i < cloud.size(); i += stride) {
        if (!cloud.points_in_rig[i].allFinite()) continue;
        const Vector3d p = ct_from_rig * cloud.points_in_rig[i];
        const SkinPoint* skin = lut.nearest_skin(p);
        if (!skin || skin->flags != kSkin) continue;
        const Vector3d normal = skin->normal_in_ct.cast<double>();
        if (has_normals && !((ct_from_rig.linear() * cloud.normals_in_rig[i]).dot(normal) > facing_cosine)) continue;
        const double distance_mm = (p - skin->position_in_ct.cast<double>()).dot(normal);
        if (!(distance_mm > -most_inside_mm && distance_mm < most_outside_mm)) continue;
        feet.push_back({p - distance_mm * normal, distance_mm});
    }
    return feet;
}

SkinCell cell_of(const Vector3d& p, double edge_mm) {
    const Eigen::Vector3i cell = (p / edge_mm).array().floor().cast<int>();
    return {cell.x(), cell.y(), cell.z()};
}

std::map<SkinCell, Gathered> gather(const std::vector<Foot>& feet, double edge_mm) {
    std::map<SkinCell, Gathered> places;
    for (const Foot& foot : feet) {
        Gathered& into = places[cell_of(foot.on_skin_in_ct, edge_mm)];
        into.sum_in_ct += foot.on_skin_in_ct;
        into.distances_mm.push_back(foot.mm);
    }
    return places;
}

SkinDisplacement::Place place_of(const Gathered& gathered, double least_sigma_mm) {
    const auto count = static_cast<double>(gathered.distances_mm.size());
    const double middle = median(gathered.distances_mm);
    std::vector<double> off;
    for (const double mm : gathered.distances_mm) off.push_back(std::abs(mm - middle));
    const double sigma_mm = 1.2533 * kSigmaOfMad * median(std::move(off)) / std::sqrt(count);
    return {gathered.sum_in_ct / count, middle, std::hypot(least_sigma_mm, sigma_mm)};
}

}  // namespace planlight
