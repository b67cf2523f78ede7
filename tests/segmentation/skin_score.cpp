#include "tests/segmentation/skin_score.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "planning_io/types/error.h"
#include "segmentation/skin_judgement.h"
#include "tests/segmentation/distance_to_mesh.h"

namespace planlight::test {
namespace {

constexpr double kOff_mm = 2;
constexpr std::size_t kEvery = 7;  // vertex of the truth is asked

std::vector<double> distances_mm(const TriangleMesh& skin, const TriangleMesh& truth) {
    TriangleMesh lids = skin;
    std::erase_if(lids.triangles, [&](const auto& t) {
        return std::all_of(t.begin(), t.end(),
                           [&](auto c) { return skin.flags[static_cast<std::size_t>(c)] == kSkin; });
    });
    const DistanceToMesh distance(skin);
    std::optional<DistanceToMesh> from_lid;
    if (!lids.triangles.empty()) from_lid.emplace(lids);
    std::vector<double> mm;
    for (std::size_t v = 0; v < truth.vertices_in_ct.size(); v += kEvery) {
        if (truth.flags[v] != kSkin) continue;
        const double here = distance(truth.vertices_in_ct[v]);
        if (here < 0.5 || !from_lid || (*from_lid)(truth.vertices_in_ct[v]) > here + 0.5) mm.push_back(here);
    }
    std::sort(mm.begin(), mm.end());
    return mm;
}

}  // namespace

SkinScore score_of(const Volume& volume, const TriangleMesh& truth) {
    SkinScore score;
    score.off_percent = score.p95_mm = NAN;
    try {
        const SkinMask mask = segment_skin(volume);
        score.skin = triangulate_skin(volume, mask);
        const SkinJudgement judged = judge_skin(volume, mask, score.skin);
        refuse_implausible(judged);
        for (const SkinDoubt& d : judged.doubts) {
            score.doubted = score.doubted || !d.finding.starts_with("The volume ends");
            score.why += d.finding.substr(0, 60) + "; ";
        }
        const std::vector<double> mm = distances_mm(score.skin, truth);
        if (mm.empty()) return score;
        score.p95_mm = mm[mm.size() * 95 / 100];
        score.sigma_mm = judged.sigma_mm;
        score.echo = judged.echo;
        score.noise_sigma_mm = judged.noise_sigma_mm;
        const auto near = std::upper_bound(mm.begin(), mm.end(), kOff_mm);
        score.rms_mm =
            std::sqrt(std::inner_product(mm.begin(), near, mm.begin(), 0.0) / static_cast<double>(near - mm.begin()));
        score.off_percent = 100.0 * static_cast<double>(mm.end() - std::upper_bound(mm.begin(), mm.end(), kOff_mm)) /
                            static_cast<double>(mm.size());
    } catch (const Error& error) {
        score.refused = true;
        score.why = error.what();
    }
    return score;
}

}  // namespace planlight::test
