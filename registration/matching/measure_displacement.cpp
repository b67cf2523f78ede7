#include "registration/matching/measure_displacement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "planning_io/types/statistics.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kSigmaOfMad = 1.4826;  // median absolute deviation of a Gaussian -> its sigma

/// Where a point of the scan stands over the CT's skin.
struct Foot {
    Vector3d on_skin_in_ct;
    double mm;
};

/// Signed distances are to the tangent plane of the nearest point of the table: it is exact on flat skin and off by
/// 0.01 mm at a radius of 20 mm, where the coarse distance field cuts corners.
std::vector<Foot> feet_of(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                          const DisplacementSettings& settings) {
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
        if (has_normals && !((ct_from_rig.linear() * cloud.normals_in_rig[i]).dot(normal) > settings.facing_cosine))
            continue;
        const double distance_mm = (p - skin->position_in_ct.cast<double>()).dot(normal);
        if (!(std::abs(distance_mm) < settings.most_mm)) continue;
        feet.push_back({p - distance_mm * normal, distance_mm});
    }
    return feet;
}

/// The scan's points over one place of the CT's skin.
struct Gathered {
    Vector3d sum_in_ct = Vector3d::Zero();
    std::vector<double> distances_mm;
};

using Places = std::map<std::array<int, 3>, Gathered>;

Places gather(const std::vector<Foot>& feet, double apart_mm) {
    Places places;
    for (const Foot& foot : feet) {
        const Eigen::Vector3i cell = (foot.on_skin_in_ct / apart_mm).array().floor().cast<int>();
        Gathered& into = places[{cell.x(), cell.y(), cell.z()}];
        into.sum_in_ct += foot.on_skin_in_ct;
        into.distances_mm.push_back(foot.mm);
    }
    return places;
}

/// Leaves places of `min_points` and more. Whether they hold most of the points: where a scan is thin (its points were
/// spent on cloth) small places lose nearly all.
bool keep_full(Places& places, std::size_t points, const DisplacementSettings& settings) {
    constexpr double kMost = 0.7;
    std::size_t kept = 0;
    std::erase_if(places, [&](const auto& entry) {
        const std::size_t count = entry.second.distances_mm.size();
        const bool full = count >= static_cast<std::size_t>(settings.min_points);
        kept += full ? count : 0;
        return !full;
    });
    return static_cast<double>(kept) >= kMost * static_cast<double>(points);
}

double sigma_of_median(const std::vector<double>& values, double middle) {
    std::vector<double> off;
    for (const double v : values) off.push_back(std::abs(v - middle));
    return 1.2533 * kSigmaOfMad * median(std::move(off)) / std::sqrt(static_cast<double>(values.size()));
}

}  // namespace

SkinDisplacement measure_displacement(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                                      const DisplacementSettings& settings) {
    constexpr double kWider = 1.5;
    SkinDisplacement result;
    const std::vector<Foot> feet = feet_of(cloud, lut, ct_from_rig, settings);
    double apart_mm = settings.apart_mm;
    Places places = gather(feet, apart_mm);
    while (!keep_full(places, feet.size(), settings) && kWider * apart_mm <= settings.most_apart_mm) {
        apart_mm *= kWider;
        places = gather(feet, apart_mm);
    }
    std::vector<double> all_mm;
    for (const auto& [cell, place] : places) {
        const double middle = median(place.distances_mm);
        const Vector3d p = place.sum_in_ct / static_cast<double>(place.distances_mm.size());
        result.places.push_back(
            {p, middle, std::hypot(settings.least_sigma_mm, sigma_of_median(place.distances_mm, middle))});
        all_mm.push_back(middle);
    }
    if (static_cast<int>(result.places.size()) < settings.min_places) return {};
    result.apart_mm = apart_mm;
    result.alike_over_mm = settings.alike_over_mm;
    result.offset_mm = median(all_mm);
    for (double& mm : all_mm) mm = std::abs(mm - result.offset_mm);
    result.spread_mm = std::max(0.05, kSigmaOfMad * median(std::move(all_mm)));
    return result;
}

}  // namespace planlight
