#include "registration/matching/measure_displacement.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
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
                          const DisplacementSettings& settings, double most_inside_mm, double most_outside_mm) {
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
        if (!(distance_mm > -most_inside_mm && distance_mm < most_outside_mm)) continue;
        feet.push_back({p - distance_mm * normal, distance_mm});
    }
    return feet;
}

/// The scan's points over one place of the CT's skin.
struct Gathered {
    Vector3d sum_in_ct = Vector3d::Zero();
    std::vector<double> distances_mm;
};

using Cell = std::array<int, 3>;
using Places = std::map<Cell, Gathered>;

Cell cell_of(const Vector3d& p, double apart_mm) {
    const Eigen::Vector3i cell = (p / apart_mm).array().floor().cast<int>();
    return {cell.x(), cell.y(), cell.z()};
}

Places gather(const std::vector<Foot>& feet, double apart_mm) {
    Places places;
    for (const Foot& foot : feet) {
        Gathered& into = places[cell_of(foot.on_skin_in_ct, apart_mm)];
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

template <class Use>
void for_neighbours(const Cell& cell, const Use& use) {
    for (int n = 0; n < 27; ++n)
        if (n != 13) use(Cell{cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
}

/// A cell of the CT's skin with what the scan saw over it.
struct Seen {
    Vector3d p_in_ct;
    double mm;
    bool skin;       ///< found to be
    int swell = -1;  ///< which swelling it belongs to
};
using SeenCells = std::map<Cell, Seen>;

SeenCells seen_cells(const Places& all, const SkinDisplacement& skin) {
    SeenCells cells;
    for (const auto& place : skin.places)
        cells.insert_or_assign(cell_of(place.p_in_ct, skin.apart_mm), Seen{place.p_in_ct, place.mm, true});
    for (const auto& [cell, gathered] : all)
        cells.try_emplace(cell, Seen{gathered.sum_in_ct / static_cast<double>(gathered.distances_mm.size()),
                                     median(gathered.distances_mm), false});
    return cells;
}

/// Skin lies all round it: cloth goes on, or out of the scan, to one side at least. Of its rim three quarters must be
/// skin, and from its middle no third of the way round without any.
bool is_swelling(const SeenCells& cells, const std::vector<Cell>& part, const std::map<Cell, bool>& rim) {
    constexpr double kOfRim = 0.75, kWidestGap = 2.1;
    std::vector<Vector3d> skin;
    for (const auto& [cell, is_skin] : rim)
        if (is_skin) skin.push_back(cells.at(cell).p_in_ct);
    if (skin.size() < 3 || static_cast<double>(skin.size()) < kOfRim * static_cast<double>(rim.size())) return false;
    Vector3d middle = Vector3d::Zero();
    for (const Cell& cell : part) middle += cells.at(cell).p_in_ct / static_cast<double>(part.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Vector3d& p : skin) scatter += (p - middle) * (p - middle).transpose();
    const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
    std::vector<double> round;
    for (const Vector3d& p : skin)
        round.push_back(std::atan2(axes.col(1).dot(p - middle), axes.col(2).dot(p - middle)));
    std::sort(round.begin(), round.end());
    double gap = round.front() + 2 * std::numbers::pi - round.back();
    for (std::size_t i = 1; i < round.size(); ++i) gap = std::max(gap, round[i] - round[i - 1]);
    return gap < kWidestGap;
}

/// Marks the cells that rise from the skin without a step, in connected parts, each bordered by skin: 1 and up. Those
/// of others, as of cloth that leaves the skin slowly and goes on beyond, are marked -2.
void find_swellings(SeenCells& cells, double most_rise_mm) {
    std::vector<Cell> front;
    for (const auto& [cell, seen] : cells)
        if (seen.skin) front.push_back(cell);
    std::vector<Cell> risen;
    while (!front.empty()) {
        const Cell cell = front.back();
        front.pop_back();
        const double mm = cells.at(cell).mm;
        for_neighbours(cell, [&](const Cell& next) {
            const auto found = cells.find(next);
            if (found == cells.end() || found->second.skin || found->second.swell >= 0 ||
                std::abs(found->second.mm - mm) > most_rise_mm)
                return;
            found->second.swell = 0;  // of which one is told below
            risen.push_back(next);
            front.push_back(next);
        });
    }
    int number = 0;
    for (const Cell& first : risen) {
        if (cells.at(first).swell != 0) continue;
        ++number;
        std::vector<Cell> part{first};
        cells.at(first).swell = number;
        std::map<Cell, bool> rim;  // of cells that are skin, or else covered
        for (std::size_t i = 0; i < part.size(); ++i)
            for_neighbours(Cell(part[i]), [&](const Cell& next) {
                const auto found = cells.find(next);
                if (found == cells.end()) return;
                if (found->second.swell == 0) {
                    found->second.swell = number;
                    part.push_back(next);
                } else if (found->second.swell < 0) {
                    rim[next] = found->second.skin;
                }
            });
        if (!is_swelling(cells, part, rim))
            for (const Cell& cell : part) cells.at(cell).swell = -2;
    }
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
    const std::vector<Foot> feet = feet_of(cloud, lut, ct_from_rig, settings, settings.most_mm, settings.most_mm);
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

void add_covered_skin(const PointCloud& all, const SkinLut& lut, const RigidTransform& ct_from_rig,
                      SkinDisplacement& skin, const DisplacementSettings& settings) {
    if (!skin.known()) return;
    Places places = gather(feet_of(all, lut, ct_from_rig, settings, settings.least_cover_mm, settings.most_cover_mm),
                           skin.apart_mm);
    std::erase_if(places, [&](const auto& entry) {
        return entry.second.distances_mm.size() < static_cast<std::size_t>(settings.min_points);
    });
    SeenCells cells = seen_cells(places, skin);
    constexpr double kRim_mm = 1;
    const double least_mm = skin.offset_mm + settings.least_cover_mm;
    find_swellings(cells, settings.most_slope * skin.apart_mm);
    for (const auto& [cell, seen] : cells) {
        if (seen.skin || seen.mm < least_mm) continue;
        bool rim = false;  // of skin that was found, which is displaced there
        for_neighbours(cell, [&](const Cell& next) {
            const auto found = cells.find(next);
            rim = rim || (found != cells.end() && found->second.skin && std::abs(found->second.mm - seen.mm) < kRim_mm);
        });
        if (rim) continue;
        skin.covered.push_back({seen.p_in_ct, seen.mm});
        if (seen.swell <= 0) continue;
        const std::vector<double>& distances_mm = places.at(cell).distances_mm;
        skin.places.push_back(
            {seen.p_in_ct, seen.mm, std::hypot(settings.least_sigma_mm, sigma_of_median(distances_mm, seen.mm))});
    }
}

}  // namespace planlight
