#include "registration/matching/find_skin.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "registration/matching/gauss_newton.h"
#include "registration/matching/pose_search.h"
#include "registration/matching/scan_parts.h"
#include "registration/matching/skin_cells.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kDistinct_mm = 8, kDistinct_rad = 8 * std::numbers::pi / 180;

struct Pose {
    RigidTransform ct_from_rig;
    double explained = 0;
    int agreeing = 1;
};

/// The poses that one part leads to, the best by what they explain of the whole scan.
std::vector<Pose> poses_of_part(const CloudPieces& pieces, const ScanCells& scan, const ScanPart& part,
                                const MatchingSkin& skin, const InitialMatchSettings& search_settings) {
    constexpr std::size_t kKept = 8;
    std::vector<SurfaceSite> sites;
    for (const int c : part.cells) {
        const CloudCell& cell = pieces.cells[static_cast<std::size_t>(c)];
        Vector3f sum = Vector3f::Zero();
        float count = 1;
        sum += cell.normal;
        for (const int other : cell.touching) sum += pieces.cells[static_cast<std::size_t>(other)].normal, count += 1;
        sites.push_back({cell.position, sum.normalized(), sum.norm() > 0.75F * count});
    }
    const std::vector<Base> bases = choose_bases(sites, scan.settings.bases_per_place, search_settings.seed);
    const PoseSearch search = prepare_search(std::move(sites), skin, search_settings);
    std::vector<Pose> poses;
    std::size_t scored = 0;
    for (const Base& base : bases) {
        std::vector<MatchCandidate> candidates = candidates_of_base(search, base, scored);
        std::stable_sort(candidates.begin(), candidates.end(),
                         [](const auto& a, const auto& b) { return a.cost_mm < b.cost_mm; });
        for (std::size_t i = 0; i < std::min(candidates.size(), kKept); ++i)
            poses.push_back({candidates[i].ct_from_rig, explained(scan, scan.judging, candidates[i].ct_from_rig)});
    }
    return poses;
}

struct Known {
    std::vector<Pose> poses;  ///< distinct, best first
    Vector3d centre_in_rig;

    bool same(const RigidTransform& a, const RigidTransform& b) const {
        return (a * centre_in_rig - b * centre_in_rig).norm() < kDistinct_mm && angle_between(a, b) < kDistinct_rad;
    }
    void sort() {
        std::stable_sort(poses.begin(), poses.end(),
                         [](const Pose& a, const Pose& b) { return a.explained > b.explained; });
    }
    /// Adds what one part led to; a pose that is known gains an agreeing part, once.
    void add(const std::vector<Pose>& fresh) {
        const std::size_t before = poses.size();
        std::vector<char> agreed(before, 0);
        for (const Pose& pose : fresh) {
            const auto known = std::find_if(poses.begin(), poses.end(),
                                            [&](const Pose& p) { return same(p.ct_from_rig, pose.ct_from_rig); });
            if (known == poses.end()) {
                poses.push_back(pose);
                continue;
            }
            const auto at = static_cast<std::size_t>(known - poses.begin());
            if (at < before && !agreed[at]) ++known->agreeing, agreed[at] = 1;
            if (pose.explained > known->explained)
                known->ct_from_rig = pose.ct_from_rig, known->explained = pose.explained;
        }
        sort();
    }
    void drop_twins() {
        sort();
        std::vector<Pose> distinct;
        for (const Pose& pose : poses) {
            const auto known = std::find_if(distinct.begin(), distinct.end(),
                                            [&](const Pose& p) { return same(p.ct_from_rig, pose.ct_from_rig); });
            if (known == distinct.end())
                distinct.push_back(pose);
            else
                known->agreeing = std::max(known->agreeing, pose.agreeing);
        }
        poses = std::move(distinct);
    }
    double ratio() const {
        return poses.size() < 2 ? 0 : (poses[0].explained + 1) / std::max(poses[1].explained + 1, 1.);
    }
};

std::vector<int> all_of(const ScanCells& scan) {
    std::vector<int> all(scan.cells.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
}

/// Draws the pose onto the cells near the skin alone, a few times.
void settle(const ScanCells& scan, const std::vector<int>& all, Pose& pose) {
    constexpr int kRounds = 3;
    constexpr double kNear_mm = 4;
    pose.explained = explained(scan, all, pose.ct_from_rig);
    for (int round = 0; round < kRounds; ++round) {
        std::vector<Vector3d> near;
        for (const int c : all) {
            const ScanCells::Cell& cell = scan.cells[static_cast<std::size_t>(c)];
            double mm;
            Vector3d gradient;
            if (!scan.field.sample(pose.ct_from_rig * cell.position, mm, gradient) || std::abs(mm) > kNear_mm) continue;
            if (gradient.dot(pose.ct_from_rig.linear() * cell.normal) > kFacing * gradient.norm())
                near.push_back(cell.position);
        }
        if (near.size() < 12) return;
        Vector3d centre = Vector3d::Zero();
        for (const Vector3d& p : near) centre += p / static_cast<double>(near.size());
        const RigidTransform moved = refine_roughly(PointArrays(near, centre), scan.field, pose.ct_from_rig);
        const double now = explained(scan, all, moved);
        if (now <= pose.explained) return;
        pose.ct_from_rig = moved;
        pose.explained = now;
    }
}

FoundSkin evidence(const PointCloud& cloud, const CloudPieces& pieces, const ScanCells& scan, const Known& known) {
    FoundSkin found;
    const Pose& best = known.poses.front();
    found.ct_from_rig = best.ct_from_rig;
    found.explained = best.explained;
    found.rival_ratio = known.ratio();
    found.places_agreeing = best.agreeing;
    const std::vector<char> kept = skin_cells(pieces, scan, best.ct_from_rig);
    found.goes_on_fraction = goes_on(pieces, scan, best.ct_from_rig, kept);
    found.is_skin.assign(cloud.size(), 0);
    for (std::size_t i = 0; i < cloud.size(); ++i)
        if (pieces.cell_of_point[i] >= 0) found.is_skin[i] = kept[static_cast<std::size_t>(pieces.cell_of_point[i])];
    double skin = 0, inside = 0;
    for (std::size_t i = 0; i < scan.cells.size(); ++i) {
        skin += kept[static_cast<std::size_t>(scan.of_pieces[i])];
        inside += lying_of(scan, scan.cells[i], best.ct_from_rig).place == CellPlace::inside;
    }
    const double count = std::max(1., static_cast<double>(scan.cells.size()));
    found.skin_fraction = skin / count;
    found.inside_fraction = inside / count;
    return found;
}

}  // namespace

std::optional<FoundSkin> find_skin(const PointCloud& cloud, const CloudPieces& pieces, const SkinLut& lut,
                                   const MatchingSkin& skin, const InitialMatch& of_whole,
                                   const InitialMatchSettings& search, const FindSkinSettings& settings) {
    constexpr int kFirst = 8, kBatch = 4, kAgreeing = 3;
    constexpr std::size_t kSettled = 12;
    const ScanCells scan = scan_cells(pieces, lut, skin.parts().field, settings, search.seed);
    if (scan.cells.size() < kLeastScanCells) return std::nullopt;
    const std::vector<ScanPart> parts = scan_parts(pieces, scan, settings);
    Known known;
    known.centre_in_rig.setZero();
    for (const ScanCells::Cell& cell : scan.cells)
        known.centre_in_rig += cell.position / static_cast<double>(scan.cells.size());
    std::vector<Pose> of_all;
    for (std::size_t i = 0; i < std::min<std::size_t>(of_whole.candidates.size(), 10); ++i)
        of_all.push_back(
            {of_whole.candidates[i].ct_from_rig, explained(scan, scan.judging, of_whole.candidates[i].ct_from_rig)});
    known.add(of_all);
    const int count = static_cast<int>(parts.size());
    int tried = 0;
    while (tried < count) {
        const int batch = std::min(tried == 0 ? kFirst : kBatch, count - tried);
        std::vector<std::vector<Pose>> found(static_cast<std::size_t>(batch));
        tbb::parallel_for(0, batch, [&](int i) {
            found[static_cast<std::size_t>(i)] =
                poses_of_part(pieces, scan, parts[static_cast<std::size_t>(tried + i)], skin, search);
        });
        for (const auto& of_part : found) known.add(of_part);
        tried += batch;
        if (!known.poses.empty() && known.poses[0].agreeing >= kAgreeing && known.ratio() >= settings.clear_ratio)
            break;
    }
    if (known.poses.empty()) return std::nullopt;
    known.poses.resize(std::min(known.poses.size(), kSettled));
    const std::vector<int> all = all_of(scan);
    tbb::parallel_for(std::size_t{0}, known.poses.size(), [&](std::size_t i) { settle(scan, all, known.poses[i]); });
    known.drop_twins();
    FoundSkin found = evidence(cloud, pieces, scan, known);
    found.places_tried = tried;
    return found;
}

}  // namespace planlight
