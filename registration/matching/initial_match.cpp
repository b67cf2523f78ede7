#include "registration/matching/initial_match.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <random>

#include "registration/matching/coarse_distance.h"
#include "registration/matching/contact_triplets.h"
#include "registration/matching/distance_field.h"
#include "registration/matching/gauss_newton.h"
#include "registration/matching/surface_sites.h"

namespace planlight {

namespace {
constexpr double kCoarseSlack_mm = 2;  // a contact pose is not yet exact
}

struct MatchingSkin::Parts {
    DistanceField field;
    CoarseDistance coarse;
    SkinPairs pairs;
    Parts(const SkinLut& lut, const InitialMatchSettings& settings)
        : field(lut),
          coarse(lut, settings.truncation_mm, settings.truncation_outside_mm + kCoarseSlack_mm),
          pairs(sites_of_skin(lut, settings.model_spacing_mm, settings.seed)) {}
};

MatchingSkin::MatchingSkin(const SkinLut& lut, const InitialMatchSettings& settings)
    : parts_(std::make_unique<const Parts>(lut, settings)) {}
MatchingSkin::~MatchingSkin() = default;
MatchingSkin::MatchingSkin(MatchingSkin&&) noexcept = default;

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kDistinct_mm = 8, kDistinct_rad = 8 * std::numbers::pi / 180;
constexpr std::size_t kRefinePoints = 250, kRankPoints = 500;

/// What all bases share: the scan as sites, in a random but fixed order, and the skin it is tried on.
struct Search {
    const MatchingSkin::Parts& skin;
    std::vector<SurfaceSite> scan;
    std::vector<Vector3f> scoring;
    PointArrays refining, ranking;  // about the scan's centre
    PointArrays ranking_normals;
    Vector3d centre_in_rig = Vector3d::Zero();
    InitialMatchSettings settings;
};

bool same_pose(const Search& search, const RigidTransform& a, const RigidTransform& b) {
    return (a * search.centre_in_rig - b * search.centre_in_rig).norm() < kDistinct_mm &&
           angle_between(a, b) < kDistinct_rad;
}

Search prepare_search(const PointCloud& cloud, const MatchingSkin& skin, const InitialMatchSettings& settings) {
    Search search{skin.parts(), sites_of_cloud(cloud), {}, {}, {}, {}, Vector3d::Zero(), settings};
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

struct ScoredPose {
    float cost_mm;
    ContactPose pose;
};

/// The poses of one base that fail least, on the coarse table. Keeps the best few hundred while it looks.
std::vector<ScoredPose> best_contact_poses(const Search& search, const Base& base, std::size_t& scored) {
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

/// Mean truncated distance of up to `kRankPoints` sites, trilinear; a site that faces the wrong way counts in full, one
/// that lies outside of the body little, one beyond the table half: a stray, or the patient beyond the CT's end.
double mean_failure(const Search& search, const RigidTransform& ct_from_rig) {
    constexpr double kBeyond = 0.5;
    const PointArrays &p = search.ranking, &n = search.ranking_normals;
    const double sum = match_kernels::sum_failure(
        p.x.data(), p.y.data(), p.z.data(), n.x.data(), n.y.data(), n.z.data(), p.size(), search.skin.field.plain(),
        placing_of(ct_from_rig, p.centre, search.skin.field, ct_from_rig * p.centre),
        static_cast<float>(search.settings.truncation_mm), static_cast<float>(search.settings.truncation_outside_mm),
        static_cast<float>(kBeyond * search.settings.truncation_mm));
    return sum / static_cast<double>(std::max<std::size_t>(p.size(), 1));
}

/// Improves the best few further, on more points: the first steps may stop short where much of the scan is cloth.
void polish(const Search& search, std::vector<MatchCandidate>& candidates) {
    constexpr std::size_t kBest = 5;
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return a.cost_mm < b.cost_mm; });
    for (std::size_t i = 0; i < std::min(candidates.size(), kBest); ++i) {
        const RigidTransform pose = refine_roughly(search.ranking, search.skin.field, candidates[i].ct_from_rig);
        const double cost_mm = mean_failure(search, pose);
        if (cost_mm < candidates[i].cost_mm) candidates[i] = {pose, cost_mm, 1};
    }
}

/// The distinct minima that one base leads to.
std::vector<MatchCandidate> candidates_of_base(const Search& search, const Base& base, std::size_t& scored) {
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

/// Adds one base's minima to those known; a minimum that is known already gains an agreeing base (once).
void merge(const Search& search, std::vector<MatchCandidate> fresh, std::vector<MatchCandidate>& known) {
    std::stable_sort(fresh.begin(), fresh.end(), [](const auto& a, const auto& b) { return a.cost_mm < b.cost_mm; });
    const std::size_t before = known.size();
    std::vector<bool> agreed(before, false);
    for (const MatchCandidate& candidate : fresh) {
        const auto same = std::find_if(known.begin(), known.end(), [&](const MatchCandidate& other) {
            return same_pose(search, candidate.ct_from_rig, other.ct_from_rig);
        });
        if (same == known.end()) {
            known.push_back(candidate);
            continue;
        }
        const auto at = static_cast<std::size_t>(same - known.begin());
        if (at < before && !agreed[at]) {
            agreed[at] = true;
            ++same->agreeing_bases;
        }
        if (candidate.cost_mm < same->cost_mm) {
            same->cost_mm = candidate.cost_mm;
            same->ct_from_rig = candidate.ct_from_rig;
        }
    }
    std::stable_sort(known.begin(), known.end(), [](const auto& a, const auto& b) { return a.cost_mm < b.cost_mm; });
}

/// Two minima that crept together while they were improved are one.
void drop_twins(const Search& search, std::vector<MatchCandidate>& sorted) {
    std::vector<MatchCandidate> distinct;
    for (const MatchCandidate& candidate : sorted) {
        const auto same = std::find_if(distinct.begin(), distinct.end(), [&](const MatchCandidate& other) {
            return same_pose(search, candidate.ct_from_rig, other.ct_from_rig);
        });
        if (same == distinct.end())
            distinct.push_back(candidate);
        else
            same->agreeing_bases = std::max(same->agreeing_bases, candidate.agreeing_bases);
    }
    sorted = std::move(distinct);
}

double runner_up_ratio(const std::vector<MatchCandidate>& sorted) {
    constexpr double kNoise_mm = 0.05;  // a perfect fit must not make any second look far
    return sorted.size() < 2 ? 0 : (sorted[1].cost_mm + kNoise_mm) / (sorted[0].cost_mm + kNoise_mm);
}

}  // namespace

InitialMatch find_initial_match(const PointCloud& cloud, const SkinLut& lut, const InitialMatchSettings& settings) {
    if (lut.distance_mm.empty() || lut.skin.empty()) return {};
    return find_initial_match(cloud, MatchingSkin(lut, settings), settings);
}

InitialMatch find_initial_match(const PointCloud& cloud, const MatchingSkin& skin,
                                const InitialMatchSettings& settings) {
    constexpr double kClearRatio = 1.15;
    constexpr int kAgreeing = 2, kBatch = 2, kPatientBases = 12;
    InitialMatch match;
    const Search search = prepare_search(cloud, skin, settings);
    const std::vector<Base> bases = choose_bases(search.scan, settings.max_bases, settings.seed);
    const auto count = static_cast<int>(bases.size());
    while (match.bases_tried < count) {
        const int first = match.bases_tried;
        const int batch = std::min(first == 0 ? std::max(settings.min_bases, 1) : kBatch, count - first);
        std::vector<std::vector<MatchCandidate>> found(static_cast<std::size_t>(batch));
        std::vector<std::size_t> scored(static_cast<std::size_t>(batch), 0);
        tbb::parallel_for(0, batch, [&](int i) {
            const auto at = static_cast<std::size_t>(i);
            found[at] = candidates_of_base(search, bases[static_cast<std::size_t>(first + i)], scored[at]);
        });
        for (auto& of_base : found) merge(search, std::move(of_base), match.candidates);
        for (const std::size_t n : scored) match.poses_scored += n;
        drop_twins(search, match.candidates);
        match.bases_tried += batch;
        match.runner_up_ratio = runner_up_ratio(match.candidates);
        if (match.candidates.empty()) continue;
        const MatchCandidate& best = match.candidates[0];
        // A poor fit may be clear and agreed on because the right pose has not been met yet: the poorer, the longer it
        // is looked for.
        const bool fits = best.cost_mm < (match.bases_tried < kPatientBases ? 0.1 : 0.15) * settings.truncation_mm;
        if (fits && best.agreeing_bases >= kAgreeing && match.runner_up_ratio >= kClearRatio) break;
    }
    if (match.candidates.size() > static_cast<std::size_t>(settings.candidates))
        match.candidates.resize(static_cast<std::size_t>(settings.candidates));
    return match;
}

}  // namespace planlight
