#include "registration/matching/covered_skin.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "planning_io/types/statistics.h"
#include "registration/matching/scan_places.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

template <class Use>
void for_neighbours(const SkinCell& cell, const Use& use) {
    for (int n = 0; n < 27; ++n)
        if (n != 13) use(SkinCell{cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
}

/// A cell of the CT's skin with what the scan saw over it.
struct Seen {
    Vector3d p_in_ct;
    double mm;
    bool skin;  ///< found to be
    /// The number of its swelling, from 1; 0: it rises without a step, of which swelling is not told yet; -1: it does
    /// not; -2: it does, and is cloth.
    int swell = -1;
};
using SeenCells = std::map<SkinCell, Seen>;

SeenCells seen_cells(const std::map<SkinCell, Gathered>& all, const SkinDisplacement& skin) {
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
bool is_swelling(const SeenCells& cells, const std::vector<SkinCell>& part, const std::map<SkinCell, bool>& rim) {
    constexpr double kOfRim = 0.75, kWidestGap = 2.1;
    std::vector<Vector3d> skin;
    for (const auto& [cell, is_skin] : rim)
        if (is_skin) skin.push_back(cells.at(cell).p_in_ct);
    if (skin.size() < 3 || static_cast<double>(skin.size()) < kOfRim * static_cast<double>(rim.size())) return false;
    Vector3d middle = Vector3d::Zero();
    for (const SkinCell& cell : part) middle += cells.at(cell).p_in_ct / static_cast<double>(part.size());
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
    std::vector<SkinCell> front;
    for (const auto& [cell, seen] : cells)
        if (seen.skin) front.push_back(cell);
    std::vector<SkinCell> risen;
    while (!front.empty()) {
        const SkinCell cell = front.back();
        front.pop_back();
        const double mm = cells.at(cell).mm;
        for_neighbours(cell, [&](const SkinCell& next) {
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
    for (const SkinCell& first : risen) {
        if (cells.at(first).swell != 0) continue;
        ++number;
        std::vector<SkinCell> part{first};
        cells.at(first).swell = number;
        std::map<SkinCell, bool> rim;  // of cells that are skin, or else covered
        for (std::size_t i = 0; i < part.size(); ++i)
            for_neighbours(SkinCell(part[i]), [&](const SkinCell& next) {
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
            for (const SkinCell& cell : part) cells.at(cell).swell = -2;
    }
}

}  // namespace

void add_covered_skin(const PointCloud& all, const SkinLut& lut, const RigidTransform& ct_from_rig,
                      SkinDisplacement& skin, const CoveredSkinSettings& settings) {
    if (!skin.known()) return;
    auto gathered = gather(feet_of(all, lut, ct_from_rig, settings.facing_cosine, settings.least_mm, settings.most_mm),
                           skin.apart_mm);
    std::erase_if(gathered, [&](const auto& entry) { return entry.second.distances_mm.size() < settings.min_points; });
    SeenCells cells = seen_cells(gathered, skin);
    constexpr double kRim_mm = 1;
    const double least_mm = skin.offset_mm + settings.least_mm;
    find_swellings(cells, settings.most_slope * skin.apart_mm);
    for (const auto& [cell, seen] : cells) {
        if (seen.skin || seen.mm < least_mm) continue;
        bool rim = false;  // of skin that was found, which is displaced there
        for_neighbours(cell, [&](const SkinCell& next) {
            const auto found = cells.find(next);
            rim = rim || (found != cells.end() && found->second.skin && std::abs(found->second.mm - seen.mm) < kRim_mm);
        });
        if (rim) continue;
        skin.covered.push_back({seen.p_in_ct, seen.mm});
        if (seen.swell <= 0) continue;
        skin.places.push_back(place_of(gathered.at(cell), settings.least_sigma_mm));
    }
}

}  // namespace planlight
