#include "registration/matching/initial_match.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "registration/matching/pose_search.h"

namespace planlight {

MatchingSkin::MatchingSkin(const SkinLut& lut, const InitialMatchSettings& settings)
    : parts_(std::make_unique<const Parts>(lut, settings)) {}
MatchingSkin::~MatchingSkin() = default;
MatchingSkin::MatchingSkin(MatchingSkin&&) noexcept = default;

namespace {

/// Adds one base's minima to those known; a minimum that is known already gains an agreeing base (once).
void merge(const PoseSearch& search, std::vector<MatchCandidate> fresh, std::vector<MatchCandidate>& known) {
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
void drop_twins(const PoseSearch& search, std::vector<MatchCandidate>& sorted) {
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
    const PoseSearch search = prepare_search(sites_of_cloud(cloud), skin, settings);
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
