#include "registration/matching/pose_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "registration/matching/gauss_newton.h"

namespace planlight {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr double kCoarseSlack_mm = 2;  // a contact pose is not yet exact
constexpr double kDistinct_mm = 8, kDistinct_rad = 8 * std::numbers::pi / 180;
constexpr std::size_t kRefinePoints = 250, kRankPoints = 500;

}  // namespace

MatchingSkin::Parts::Parts(const SkinLut& lut, const InitialMatchSettings& settings)
    : field(lut),
      coarse(lut, settings.truncation_mm, settings.truncation_outside_mm + kCoarseSlack_mm),
      pairs(sites_of_skin(lut, settings.model_spacing_mm, settings.seed)) {}

bool same_pose(const PoseSearch& search, const RigidTransform& a, const RigidTransform& b) {
    return (a * search.centre_in_rig - b * search.centre_in_rig).norm() < kDistinct_mm &&
           angle_between(a, b) < kDistinct_rad;
}

PoseSearch prepare_search(std::vector<SurfaceSite> sites, const MatchingSkin& skin,
                          const InitialMatchSettings& settings) {
    PoseSearch search{skin.parts(), std::move(sites), {}, {}, {}, {}, Vector3d::Zero(), settings};
    std::mt19937 random(settings.seed);
    auto& scan = search.scan;
    for (std::size_t i = scan.size(); i > 1; --i) std::swap(scan[i - 1], scan[random() % i]);
    for (const SurfaceSite& s : scan) {
        if (search.scoring.size() < static_cast<std::size_t>(std::max(settings.scoring_points, 8)))
            search.scoring.push_back(s.position);
        search.centre_in_rig += s.position.cast<double>() / static_cast<double>(scan.size());
    }
    std::vector<Vector3d> positions, normals;
    for (std::size_t i = 0; i < std::min(scan.size(), kRankPoints); ++i) {
        positions.push_back(scan[i].position.cast<double>());
        normals.push_back(scan[i].normal.cast<double>());
    }
    search.ranking = PointArrays(positions, search.centre_in_rig);
    search.ranking_normals = PointArrays(normals, Vector3d::Zero());
    positions.resize(std::min(positions.size(), kRefinePoints));
    search.refining = PointArrays(positions, search.centre_in_rig);
    return search;
}

namespace {

struct ScoredPose {
    float cost_mm;
    ContactPose pose;
};

/// The poses of one base that fail least, on the coarse table. Keeps the best few hundred while it looks.
std::vector<ScoredPose> best_contact_poses(const PoseSearch& search, const Base& base, std::size_t& scored) {
    const std::size_t keep = 6 * static_cast<std::size_t>(search.settings.candidates);
    const auto better = [](const ScoredPose& a, const ScoredPose& b) { return a.cost_mm < b.cost_mm; };
    const auto points = static_cast<float>(search.scoring.size());
    std::vector<ScoredPose> heap;
    float limit = 0.8f * static_cast<float>(search.settings.truncation_mm) * points;
    for_each_contact_triplet(base, search.skin.pairs, 0.75 * search.settings.model_spacing_mm,
                             [&](const ContactPose& pose) {
                                 ++scored;
                                 const float cost = search.skin.coarse.sum(search.scoring, pose.R, pose.t, limit);
                                 if (cost >= limit) return;
                                 heap.push_back({cost, pose});
                                 std::push_heap(heap.begin(), heap.end(), better);
                                 if (heap.size() <= keep) return;
                                 std::pop_heap(heap.begin(), heap.end(), better);
                                 heap.pop_back();
                                 limit = heap.front().cost_mm;
                             });
    std::sort_heap(heap.begin(), heap.end(), better);
    return heap;
}

}  // namespace

/// Mean truncated distance of up to `kRankPoints` sites, trilinear; a site that faces the wrong way counts in full, one
/// that lies outside of the body little, one beyond the table half: a stray, or the patient beyond the CT's end.
double mean_failure(const PoseSearch& search, const RigidTransform& ct_from_rig) {
    constexpr double kBeyond = 0.5;
    const PointArrays &p = search.ranking, &n = search.ranking_normals;
    const double sum = match_kernels::sum_failure(
        p.x.data(), p.y.data(), p.z.data(), n.x.data(), n.y.data(), n.z.data(), p.size(), search.skin.field.plain(),
        placing_of(ct_from_rig, p.centre, search.skin.field, ct_from_rig * p.centre),
        static_cast<float>(search.settings.truncation_mm), static_cast<float>(search.settings.truncation_outside_mm),
        static_cast<float>(kBeyond * search.settings.truncation_mm));
    return sum / static_cast<double>(std::max<std::size_t>(p.size(), 1));
}

namespace {

/// Improves the best few further, on more points: the first steps may stop short where much of the scan is cloth.
void polish(const PoseSearch& search, std::vector<MatchCandidate>& candidates) {
    constexpr std::size_t kBest = 5;
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return a.cost_mm < b.cost_mm; });
    for (std::size_t i = 0; i < std::min(candidates.size(), kBest); ++i) {
        const RigidTransform pose = refine_roughly(search.ranking, search.skin.field, candidates[i].ct_from_rig);
        const double cost_mm = mean_failure(search, pose);
        if (cost_mm < candidates[i].cost_mm) candidates[i] = {pose, cost_mm, 1};
    }
}

}  // namespace

std::vector<MatchCandidate> candidates_of_base(const PoseSearch& search, const Base& base, std::size_t& scored) {
    std::vector<RigidTransform> starts;
    for (const ScoredPose& scored_pose : best_contact_poses(search, base, scored)) {
        RigidTransform pose = RigidTransform::Identity();
        pose.linear() = scored_pose.pose.R.cast<double>();
        pose.translation() = scored_pose.pose.t.cast<double>();
        if (std::any_of(starts.begin(), starts.end(),
                        [&](const auto& other) { return same_pose(search, pose, other); }))
            continue;
        starts.push_back(pose);
        if (starts.size() >= static_cast<std::size_t>(search.settings.candidates)) break;
    }
    std::vector<MatchCandidate> candidates;
    for (const RigidTransform& start : starts) {
        const RigidTransform pose = refine_roughly(search.refining, search.skin.field, start);
        candidates.push_back({pose, mean_failure(search, pose), 1});
    }
    polish(search, candidates);
    return candidates;
}

}  // namespace planlight
