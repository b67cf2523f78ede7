#include "registration/matching/innermost_layer.h"

#include <Eigen/Cholesky>
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
using Eigen::VectorXd;

/// The points of one small cube of ct, near the skin.
struct Place {
    std::vector<std::size_t> points;
    std::vector<double> off_mm;
    Vector3d x_in_ct = Vector3d::Zero(), normal = Vector3d::Zero();  ///< sums, then means
    double middle_mm = 0;                                            ///< median of the points' signed distances
};

std::vector<Place> places_of(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig) {
    constexpr double kPlace_mm = 5, kFar_mm = 4;
    constexpr std::size_t kFewest = 4;
    std::map<std::array<int, 3>, Place> cells;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (!cloud.points_in_rig[i].allFinite()) continue;
        const Vector3d p = ct_from_rig * cloud.points_in_rig[i];
        const SkinPoint* skin = lut.nearest_skin(p);
        if (!skin || skin->flags != kSkin) continue;
        const Vector3d normal = skin->normal_in_ct.cast<double>();
        const double off_mm = (p - skin->position_in_ct.cast<double>()).dot(normal);
        if (!(std::abs(off_mm) < kFar_mm)) continue;
        const Eigen::Vector3i at = (p / kPlace_mm).array().floor().cast<int>();
        Place& place = cells[{at.x(), at.y(), at.z()}];
        place.points.push_back(i);
        place.off_mm.push_back(off_mm);
        place.x_in_ct += p;
        place.normal += normal;
    }
    std::vector<Place> places;
    for (auto& [at, place] : cells) {
        if (place.points.size() < kFewest) continue;
        const auto count = static_cast<double>(place.points.size());
        place.x_in_ct /= count;
        place.normal /= count;
        place.middle_mm = median(place.off_mm);
        places.push_back(std::move(place));
    }
    return places;
}

/// What of the places' distances a small movement of the head and an offset of its skin leave, when a fifth of the
/// places is to lie below and four fifths above (quantile regression, Koenker & Bassett 1978, by reweighting): a second
/// layer outside of the skin, of up to two thirds of the places, does not lift it.
std::vector<double> above_the_lowest(const std::vector<Place>& places) {
    constexpr double kShare = 0.2, kLeast_mm = 0.03;
    constexpr int kRounds = 40, kColumns = 7;
    constexpr double kLikely_mm = 2, kLever_mm = 80;
    const auto n = static_cast<Eigen::Index>(places.size());
    Vector3d centre = Vector3d::Zero();
    for (const Place& p : places) centre += p.x_in_ct / static_cast<double>(n);
    Eigen::Matrix<double, Eigen::Dynamic, kColumns> X(n, kColumns);
    VectorXd d(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Place& p = places[static_cast<std::size_t>(i)];
        X.row(i) << ((p.x_in_ct - centre).cross(p.normal) / kLever_mm).transpose(), p.normal.transpose(), 1;
        d[i] = p.middle_mm;
    }
    VectorXd left = d.array() - median(std::vector<double>(d.data(), d.data() + n));
    for (int round = 0; round < kRounds; ++round) {
        const VectorXd weights =
            left.unaryExpr([&](double r) { return (r < 0 ? 1 - kShare : kShare) / std::max(std::abs(r), kLeast_mm); });
        Eigen::Matrix<double, kColumns, kColumns> A = X.transpose() * weights.asDiagonal() * X;
        A.diagonal().head<6>().array() += weights.sum() / static_cast<double>(n) / (kLikely_mm * kLikely_mm);
        left = d - X * A.ldlt().solve(X.transpose() * weights.cwiseProduct(d));
    }
    return {left.data(), left.data() + n};
}

/// Up to where the lowest layer reaches: the lowest of the dense places, and as far above it as the values below
/// spread.
double top_of_lowest_layer(std::vector<double> values) {
    constexpr double kBin_mm = 0.02, kWidth_mm = 0.06, kOfHighest = 0.35, kSigmaOfMedian = 1.4826, kScales = 3;
    constexpr double kLeastScale_mm = 0.06, kMostScale_mm = 0.4, kFrom_mm = -2, kTo_mm = 2;
    constexpr auto kBins = static_cast<std::size_t>((kTo_mm - kFrom_mm) / kBin_mm);
    std::array<double, kBins> density{};
    for (std::size_t b = 0; b < kBins; ++b)
        for (const double v : values) {
            const double z = (kFrom_mm + kBin_mm * (static_cast<double>(b) + 0.5) - v) / kWidth_mm;
            if (std::abs(z) < 4) density[b] += std::exp(-z * z / 2);
        }
    const double highest = *std::max_element(density.begin(), density.end());
    std::size_t peak = 1;
    while (peak + 1 < kBins && !(density[peak] >= kOfHighest * highest && density[peak] >= density[peak - 1] &&
                                 density[peak] >= density[peak + 1]))
        ++peak;
    const double peak_mm = kFrom_mm + kBin_mm * (static_cast<double>(peak) + 0.5);
    std::vector<double> below;
    for (const double v : values)
        if (v <= peak_mm) below.push_back(peak_mm - v);
    const double scale_mm = std::clamp(kSigmaOfMedian * median(std::move(below)), kLeastScale_mm, kMostScale_mm);
    return peak_mm + kScales * scale_mm;
}

}  // namespace

std::optional<PointCloud> innermost_layer(const PointCloud& cloud, const SkinLut& lut,
                                          const RigidTransform& ct_from_rig) {
    constexpr std::size_t kFewestPlaces = 40;
    constexpr double kLeastShare = 0.25;
    const std::vector<Place> places = places_of(cloud, lut, ct_from_rig);
    if (places.size() < kFewestPlaces) return std::nullopt;
    const std::vector<double> above_mm = above_the_lowest(places);
    const double top_mm = top_of_lowest_layer(above_mm);
    const auto stay = static_cast<std::size_t>(
        std::count_if(above_mm.begin(), above_mm.end(), [&](double mm) { return mm <= top_mm; }));
    if (stay == places.size() || static_cast<double>(stay) < kLeastShare * static_cast<double>(places.size()))
        return std::nullopt;
    PointCloud layer;
    const bool has_normals = cloud.normals_in_rig.size() == cloud.size();
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (above_mm[i] > top_mm) continue;
        for (const std::size_t point : places[i].points) {
            layer.points_in_rig.push_back(cloud.points_in_rig[point]);
            if (has_normals) layer.normals_in_rig.push_back(cloud.normals_in_rig[point]);
        }
    }
    return layer;
}

}  // namespace planlight
