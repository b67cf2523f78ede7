#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "segmentation/segment_skin.h"
#include "tests/segmentation/mesh_facts.h"
#include "tests/support/analytic_head.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

/// An MR of the analytic head: tissue of 600 in air of 0, blurred by 0.8 mm, the coil's side `ratio` times as bright as
/// the far one, Rician noise. `layers`: fat of 900 to 4 mm under the skin, dark bone to 10 mm, and within it brain.
/// Voxels of 1.2 x 1.2 x 1.4 mm, `coarse` times as large.
Volume mr_of_head(double ratio, double sigma = 15, bool layers = false, double coarse = 1) {
    Volume volume;
    volume.modality = "MR";
    const Vector3d low(-112, -132, -112), high(112, 134, 128), spacing = coarse * Vector3d(1.2, 1.2, 1.4);
    volume.ct_from_voxel.linear() = spacing.asDiagonal();
    volume.ct_from_voxel.translation() = low;
    for (int a = 0; a < 3; ++a)
        volume.size[static_cast<std::size_t>(a)] = static_cast<int>((high[a] - low[a]) / spacing[a]) + 1;
    static std::map<double, std::vector<float>> distances;  // the same grid for all
    std::vector<float>& mm = distances[coarse];
    if (mm.empty())
        for (int k = 0; k < volume.size[2]; ++k)
            for (int j = 0; j < volume.size[1]; ++j)
                for (int i = 0; i < volume.size[0]; ++i)
                    mm.push_back(static_cast<float>(analytic_head_distance(volume.ct_from_voxel * Vector3d(i, j, k))));
    std::mt19937 random(4);
    std::normal_distribution<double> noise(0, sigma);
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                const Vector3d p = volume.ct_from_voxel * Vector3d(i, j, k);
                const double coil = std::pow(ratio, -p.y() / 200), d = mm[volume.index(i, j, k)];
                const double tissue = !layers ? 600 : d > -4 ? 900 : d > -10 ? 60 : 500;
                const double signal = tissue * coil * 0.5 * std::erfc(d / 0.8 / std::numbers::sqrt2);
                volume.values.push_back(static_cast<float>(std::hypot(signal + noise(random), noise(random))));
            }
    return volume;
}

/// The same head with a skin of 250 and 2 mm over fat of 600: T1, as a scalp shows it.
Volume mr_of_scalp() {
    Volume volume = mr_of_head(1);
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 10);
    const auto step = [](double d) { return 0.5 * std::erfc(d / 0.9 / std::numbers::sqrt2); };
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                const double d = analytic_head_distance(volume.ct_from_voxel * Vector3d(i, j, k));
                const double signal = 250 * step(d) + 350 * step(d + 2) - 560 * step(d + 6) + 300 * step(d + 12);
                volume.values[volume.index(i, j, k)] =
                    static_cast<float>(std::hypot(signal + noise(random), noise(random)));
            }
    return volume;
}

struct Errors {
    double front = 0, back = 0, rms = 0, p99 = 0;  ///< mean before and behind, mm outwards
};

Errors errors_of(const TriangleMesh& skin) {
    std::vector<double> off;
    Errors result;
    double n_front = 0, n_back = 0;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
        const Vector3d& p = skin.vertices_in_ct[v];
        if (skin.flags[v] != kSkin) continue;
        const double d = analytic_head_distance(p);
        off.push_back(std::abs(d));
        result.rms += d * d;
        if (p.y() < -60) result.front += d, ++n_front;
        if (p.y() > 60) result.back += d, ++n_back;
    }
    std::sort(off.begin(), off.end());
    result.front /= n_front;
    result.back /= n_back;
    result.rms = std::sqrt(result.rms / static_cast<double>(off.size()));
    result.p99 = off[off.size() * 99 / 100];
    return result;
}

TEST(MrSkinEdge, LiesOnTheEdgeWhereverTheCoilIs) {
    Volume volume = mr_of_head(2);
    SkinSettings settings;
    settings.threshold = 250;  // given, so that the bias stays
    const SkinMask mask = segment_skin(volume, settings);
    const TriangleMesh skin = triangulate_skin(volume, mask, settings);
    volume.modality = "";  // the same without the move: one threshold for all
    const Errors before = errors_of(triangulate_skin(volume, mask, settings)), after = errors_of(skin);
    RecordProperty("before_rms_um", static_cast<int>(1000 * before.rms));
    RecordProperty("after_rms_um", static_cast<int>(1000 * after.rms));
    EXPECT_GT(before.front - before.back, 0.4);  // the fault is there: share of 0.5 / 1.5 against 0.5 / 0.7 of the edge
    // Under the nose's tight curve the mean of the tissue 1 to 2.5 mm beneath is low, which puts the edge 0.1 mm out.
    EXPECT_LT(std::abs(after.front - after.back), 0.15);
    EXPECT_LT(after.rms, 0.5 * before.rms);
    EXPECT_LT(after.rms, 0.12);  // a tenth of a voxel; in creases the profile sees both sides
    const MeshFacts facts = facts_of(skin);
    EXPECT_EQ(facts.bad_edges, 0U);
    EXPECT_EQ(facts.pieces, 1U);
    EXPECT_EQ(facts.euler, 2);
    EXPECT_TRUE(skin.thickness_mm.empty());
}

TEST(SegmentMrSkin, AHeadThreeTimesAsBrightInFrontIsSegmentedWhole) {
    for (const bool layers : {false, true}) {
        Volume volume = mr_of_head(3, 15, layers);
        const SkinMask mask = segment_skin(volume);
        const Errors even = errors_of(triangulate_skin(volume, mask));
        volume.modality = "";  // one threshold for all
        const Errors raw = errors_of(triangulate_skin(volume, segment_skin(volume)));
        RecordProperty(layers ? "layers_rms_um" : "rms_um", static_cast<int>(1000 * even.rms));
        RecordProperty(layers ? "layers_raw_rms_um" : "raw_rms_um", static_cast<int>(1000 * raw.rms));
        EXPECT_GT(mask.brightness_ratio, 2) << layers;
        EXPECT_LT(even.rms, layers ? 0.17 : 0.13) << layers;  // an eighth of a voxel, a tenth
        EXPECT_LT(std::abs(even.front - even.back), 0.15) << layers;
        EXPECT_GT(raw.rms, 2 * even.rms) << layers << ": the fault is there";
    }
}

TEST(MrSkinEdge, ItsSigmaIsWhatNoiseDoesToIt) {
    std::vector<double> sigmas;
    for (const double noise : {15.0, 45.0}) {
        const Volume volume = mr_of_head(1, noise);
        const SkinMask mask = segment_skin(volume);
        const TriangleMesh skin = triangulate_skin(volume, mask);
        sigmas.push_back(skin_edge_sigma_mm(volume, mask, skin));
        EXPECT_GT(sigmas.back(), 0.5 * errors_of(skin).rms) << noise;
        EXPECT_LT(sigmas.back(), 3 * errors_of(skin).rms) << noise;  // the mean over neighbours lies better
    }
    EXPECT_NEAR(sigmas[1] / sigmas[0], 3, 0.3);
}

TEST(MrSkinEdge, NoiseDoesNotPushItOutwards) {
    const Volume volume = mr_of_head(1, 100, true, 1.6);
    const SkinMask mask = segment_skin(volume);
    ASSERT_GE(mask.smoothings, 2);
    const Errors errors = errors_of(triangulate_skin(volume, mask));
    EXPECT_LT(std::abs(errors.front), 0.12);  // where the smoothed values have it 0.2 and 0.4 mm outside
    EXPECT_LT(std::abs(errors.back), 0.12);
    EXPECT_LT(errors.rms, 0.3);
}

TEST(MrSkinEdge, BrightFatUnderADimSkinDoesNotDrawItInwards) {
    const Volume volume = mr_of_scalp();
    const SkinMask mask = segment_skin(volume);
    const Errors errors = errors_of(triangulate_skin(volume, mask));
    // Voxels of 1.2 mm mix the fat into the skin: no profile shows where it ends. The half of the fat's crest lies 1.6
    // mm deep.
    RecordProperty("rms_um", static_cast<int>(1000 * errors.rms));
    RecordProperty("p99_um", static_cast<int>(1000 * errors.p99));
    EXPECT_LT(errors.rms, 0.85);
    EXPECT_LT(errors.p99, 1.25);
}

TEST(MrSkinEdge, MovesNothingFarWhereTheThresholdIsRight) {
    Volume volume = mr_of_head(1);
    SkinSettings settings;
    settings.threshold = 309;  // half way between the tissue and the noise floor in air (15 times sqrt(pi / 2))
    const SkinMask mask = segment_skin(volume, settings);
    const Errors moved = errors_of(triangulate_skin(volume, mask, settings));
    volume.modality = "";
    const Errors plain = errors_of(triangulate_skin(volume, mask, settings));
    // 1.5 mm deeper an edge of 0.8 mm (1 sigma) has risen to 97 %, and the half of that lies 0.03 mm further out.
    EXPECT_LT(moved.rms, plain.rms + 0.03);
    EXPECT_NEAR(moved.front, plain.front, 0.13);
    EXPECT_NEAR(moved.back, plain.back, 0.09);
}

}  // namespace
}  // namespace planlight::test
