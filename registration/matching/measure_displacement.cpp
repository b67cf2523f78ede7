#include "registration/matching/measure_displacement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "planning_io/types/statistics.h"
#include "registration/matching/scan_places.h"

namespace planlight {
namespace {

using Places = std::map<SkinCell, Gathered>;

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

}  // namespace

SkinDisplacement measure_displacement(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                                      const DisplacementSettings& settings) {
    constexpr double kWider = 1.5;
    SkinDisplacement result;
    const std::vector<Foot> feet =
        feet_of(cloud, lut, ct_from_rig, settings.facing_cosine, settings.most_mm, settings.most_mm);
    double apart_mm = settings.apart_mm;
    Places places = gather(feet, apart_mm);
    while (!keep_full(places, feet.size(), settings) && kWider * apart_mm <= settings.most_apart_mm) {
        apart_mm *= kWider;
        places = gather(feet, apart_mm);
    }
    std::vector<double> all_mm;
    for (const auto& [cell, place] : places) {
        result.places.push_back(place_of(place, settings.least_sigma_mm));
        all_mm.push_back(result.places.back().mm);
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
