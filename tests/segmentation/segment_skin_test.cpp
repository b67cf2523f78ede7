#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "planning_io/types/error.h"
#include "segmentation/segment_skin.h"
#include "segmentation/skin_threshold.h"
#include "tests/segmentation/analytic_heads.h"
#include "tests/segmentation/mesh_facts.h"
#include "tests/segmentation/synthetic_scan.h"
#include "tests/support/analytic_head.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

struct Errors {
    double rms = 0, p99 = 0, worst = 0;
    std::size_t count = 0;
};

/// Distances of skin vertices from where the scan crosses the threshold on the analytic head.
Errors errors_of(const TriangleMesh& mesh, double threshold,
                 const Eigen::Matrix3d& scan_from_ct = Eigen::Matrix3d::Identity()) {
    std::vector<double> errors;
    const double offset = crossing_distance_mm(threshold);
    for (std::size_t v = 0; v < mesh.vertices_in_ct.size(); ++v)
        if (mesh.flags[v] == kSkin)
            errors.push_back(std::abs(analytic_head_distance(scan_from_ct * mesh.vertices_in_ct[v]) - offset));
    std::sort(errors.begin(), errors.end());
    Errors result;
    for (const double e : errors) result.rms += e * e;
    result.count = errors.size();
    result.rms = std::sqrt(result.rms / static_cast<double>(result.count));
    result.p99 = errors[result.count * 99 / 100];
    result.worst = errors.back();
    return result;
}

struct Segmented {
    Volume scan;
    SkinMask mask;
    TriangleMesh skin;
    explicit Segmented(const ScanOptions& options)
        : scan(synthetic_scan(options)), mask(segment_skin(scan)), skin(triangulate_skin(scan, mask)) {}
};

/// The scan with all objects and openings, and the bare one: made once.
const Segmented& whole() {
    static const Segmented made{ScanOptions{}};
    return made;
}
const Segmented& bare() {
    static const Segmented made{ScanOptions{.objects = false, .openings = false}};
    return made;
}

TEST(SegmentSkin, FindsTheThresholdBetweenAirAndSoftTissue) {
    const SkinMask& mask = whole().mask;
    EXPECT_NEAR(mask.threshold, -480, 15);  // peaks -1000 and 40; bins of 10 HU, noise of 15 HU
    Volume stored = whole().scan;           // the same scan in a scanner's own numbers
    for (auto& v : stored.values) v = 2 * (v + 1024);
    stored.is_hu = false;
    EXPECT_NEAR(segment_skin(stored).threshold, 2 * (1024 - 480), 60);
}

// An MR of sixteen bits has thresholds of thousands.
TEST(SegmentSkin, SaysAThresholdAsItIsTyped) {
    EXPECT_EQ(threshold_text(12345.6), "12346");
    EXPECT_EQ(threshold_text(1234), "1234");
    EXPECT_EQ(threshold_text(-490.2), "-490");
    EXPECT_EQ(threshold_text(99.97), "100");
    EXPECT_EQ(threshold_text(-87.44), "-87.4");
    EXPECT_EQ(threshold_text(0.21449), "0.214");
    EXPECT_EQ(threshold_text(0), "0");
    EXPECT_EQ(threshold_text(0.00002), "0.00002");
    EXPECT_EQ(threshold_text(-0.000003125), "-0.00000313");
    EXPECT_EQ(threshold_text(9.996), "10");
}

TEST(TriangulateSkin, LiesOnTheCrossingOfABareHead) {
    const auto& [scan, mask, skin] = bare();
    const Errors errors = errors_of(skin, mask.threshold);
    RecordProperty("rms_um", static_cast<int>(1000 * errors.rms));
    EXPECT_GT(errors.count, 20000U);
    EXPECT_LT(errors.rms, 0.06);
    EXPECT_LT(errors.p99, 0.2 * 1.3);  // 0.2 voxel; noise of 15 HU over 500 HU/mm is 0.03 mm
    EXPECT_EQ(mask.pieces_removed, 0);
    EXPECT_TRUE(mask.warnings.empty());
}

TEST(TriangulateSkin, IsOneClosedOutwardSurfaceWithoutHandles) {
    const auto& [scan, mask, skin] = whole();
    const MeshFacts facts = facts_of(skin);
    EXPECT_EQ(facts.bad_edges, 0U);
    EXPECT_EQ(facts.pieces, 1U);
    EXPECT_EQ(facts.euler, 2);
    EXPECT_NEAR(facts.volume_ml, mask.volume_ml, 0.01 * mask.volume_ml);
    EXPECT_LE(facts.longest_edge_mm, 2.7);  // never longer than a voxel's diagonal (2.44) or the setting (2)
    ASSERT_EQ(skin.normals_in_ct.size(), skin.vertices_in_ct.size());
    std::size_t turned = 0;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v)
        if (skin.flags[v] == kSkin)
            turned += skin.normals_in_ct[v].dot(analytic_head_normal(skin.vertices_in_ct[v])) < 0.97;
    EXPECT_LT(turned, skin.vertices_in_ct.size() / 100);
}

TEST(SegmentSkin, CutsOffTablePlatesAndWireAndKeepsTheEars) {
    const auto& [scan, mask, skin] = whole();
    EXPECT_GE(mask.pieces_removed, 2);  // table and plates hang together; the wire
    EXPECT_NEAR(mask.removed_ml, 328 + 2 * 77 + 1,
                25);  // 208 x 8 x 197 mm; 3.5 x 163 x 135 mm each; thin things measure thick
    double furthest = 0, left_ear = 0, right_ear = 0;
    std::size_t off = 0, count = 0;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
        const Vector3d& p = skin.vertices_in_ct[v];
        const double d = analytic_head_distance(p);
        furthest = std::max(furthest, d);
        left_ear = std::max(left_ear, p.x());
        right_ear = std::min(right_ear, p.x());
        if (skin.flags[v] != kSkin) continue;
        ++count;
        off += std::abs(d - crossing_distance_mm(mask.threshold)) > 0.26;
    }
    EXPECT_LT(furthest,
              2.5 + 1.5 * 1.6);  // a stub where the plate touched: the detach radius and one and a half voxels
    EXPECT_GT(left_ear, 86);     // the ear's edge is at 89
    EXPECT_LT(right_ear, -84);   // at -86
    EXPECT_LT(off, count / 50);  // unflagged and off the skin: at the contacts and openings only
}

TEST(SegmentSkin, LidsNostrilsEarCanalsAndThroat) {
    const auto& [scan, mask, skin] = whole();
    std::size_t lids = 0;
    double deepest = 0;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
        lids += skin.flags[v] == kSeal;
        if (skin.flags[v] != kCutPlane) deepest = std::min(deepest, analytic_head_distance(skin.vertices_in_ct[v]));
    }
    EXPECT_GT(lids, 20U);
    EXPECT_GT(deepest,
              -8);  // the canals go 40 mm deep, the cave lies 30 mm deep; lids sit within the seal radius and its half
    const Eigen::Vector3i cave = (scan.ct_from_voxel.inverse() * Vector3d(1, -55, -30)).array().round().cast<int>();
    ASSERT_LT(scan.at(cave.x(), cave.y(), cave.z()), -900);
    EXPECT_EQ(mask.body[scan.index(cave.x(), cave.y(), cave.z())], 1);
}

TEST(TriangulateSkin, ClosesTheEndOfTheVolumeByAFlatPlane) {
    const TriangleMesh& skin = whole().skin;
    std::size_t cut = 0, misplaced = 0, flat = 0;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
        misplaced += (skin.flags[v] == kCutPlane) != (skin.vertices_in_ct[v].z() < kCutZ_mm - 0.01);
        if (skin.flags[v] != kCutPlane) continue;
        ++cut;
        flat += std::abs(skin.vertices_in_ct[v].z() - (kCutZ_mm - 0.8)) < 1e-3;  // half a slice beyond the last centres
    }
    EXPECT_GT(cut, 500U);
    EXPECT_EQ(misplaced, 0U);
    EXPECT_GT(flat, cut * 95 / 100);  // the rim rounds off within half a slice
}

TEST(TriangulateSkin, FollowsTurnedVoxelAxes) {
    ScanOptions options;
    options.objects = options.openings = false;
    options.spacing_mm = {1.6, 1.6, 1.6};
    options.ct_from_scan = Eigen::AngleAxisd(2.1, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    const Volume scan = synthetic_scan(options);
    const SkinMask mask = segment_skin(scan);
    const TriangleMesh skin = triangulate_skin(scan, mask);
    EXPECT_LT(errors_of(skin, mask.threshold, options.ct_from_scan.transpose()).p99, 0.2 * 1.6);
    EXPECT_GT(facts_of(skin).volume_ml, 1000);
}

TEST(TriangulateSkin, DecimatesWithinTheBound) {
    const auto& [scan, mask, skin] = bare();
    SkinSettings fine, coarse;
    fine.max_decimation_error_mm = 0;
    coarse.max_edge_mm = 6;
    const TriangleMesh full = triangulate_skin(scan, mask, fine), few = triangulate_skin(scan, mask, coarse);
    EXPECT_LT(few.triangles.size(), full.triangles.size() / 2);
    const Errors before = errors_of(full, mask.threshold), after = errors_of(few, mask.threshold);
    EXPECT_LT(after.worst, before.worst + 1e-9);  // vertices stay where they were
    double worst = 0;  // and triangles cut corners by no more than the bound, plus what the noise did before
    for (const auto& t : few.triangles) {
        Vector3d centre = Vector3d::Zero();
        for (const auto c : t) centre += few.vertices_in_ct[static_cast<std::size_t>(c)] / 3;
        if (centre.z() > kCutZ_mm + 3)
            worst = std::max(worst, std::abs(analytic_head_distance(centre) - crossing_distance_mm(mask.threshold)));
    }
    EXPECT_LT(worst, 0.15 + before.worst);
}

TEST(SegmentSkin, RefusesVolumesWithoutSkin) {
    Volume air;
    air.size = {40, 40, 40};
    air.is_hu = true;
    air.values.assign(64000, -1000);
    EXPECT_THROW(segment_skin(air), InputError);
    Volume body = air;
    body.values.assign(64000, 40);
    EXPECT_THROW(segment_skin(body), InputError);
    SkinSettings given;
    given.threshold = -300;
    EXPECT_THROW(segment_skin(air, given), InputError);
    EXPECT_THROW(segment_skin(body, given), InputError);
    EXPECT_THROW(segment_skin(Volume{}), InputError);
    Volume flat = air;
    flat.is_hu = false;
    EXPECT_THROW(segment_skin(flat), InputError);
    Volume pea = air;  // 20 mm wide: no head
    for (int k = 10; k < 30; ++k)
        for (int j = 10; j < 30; ++j)
            for (int i = 10; i < 30; ++i) pea.values[pea.index(i, j, k)] = 40;
    EXPECT_THROW(segment_skin(pea), InputError);
}

// As a viewer saves it: all that is darker than the window's lower end has its value.
TEST(SegmentSkin, SaysThatTheValuesWereCutOff) {
    const auto said = [](double low, double high, double slope) {
        Volume scan = bare().scan;
        scan.values[0] = 2000;  // a filling
        for (auto& v : scan.values) v = static_cast<float>(slope * (std::clamp<double>(v, low, high) - low));
        try {
            segment_skin(scan);
        } catch (const InputError& e) {
            return std::string(e.what()) + ". " + e.remedy;
        }
        return std::string("taken");
    };
    const std::string cut = said(0, 3000, 1), windowed = said(-160, 240, 255.0 / 400);
    EXPECT_NE(cut.find("its lowest value, 0 HU"), std::string::npos) << cut;
    EXPECT_EQ(cut.find("256 greys"), std::string::npos) << cut;
    EXPECT_NE(windowed.find("put into 256 greys"), std::string::npos) << windowed;
    EXPECT_NE(windowed.find("without a window"), std::string::npos) << windowed;
}

TEST(SegmentSkin, APhantomOfBoneAloneIsFoundWithItsThinSkull) {
    // A shell of 4 mm round a ball of 25 mm, that a rod of 3 mm holds.
    Volume volume;
    volume.modality = "CT";
    volume.is_hu = true;
    volume.ct_from_voxel.linear() *= 1.5;
    volume.ct_from_voxel.translation() = Eigen::Vector3d(-90, -90, -90);
    volume.size = {121, 121, 121};
    for (int k = 0; k < 121; ++k)
        for (int j = 0; j < 121; ++j)
            for (int i = 0; i < 121; ++i) {
                const Eigen::Vector3d p = volume.ct_from_voxel * Eigen::Vector3d(i, j, k);
                const double r = p.norm();
                const bool rod = std::hypot(p.x(), p.y()) < 1.6 && p.z() > 0 && r < 75;
                volume.values.push_back(r < 25 ? 60.0F : (r > 71 && r < 75) || rod ? 900.0F : -1000.0F);
            }
    SkinSettings settings;
    settings.phantom = true;
    EXPECT_NEAR(segment_skin(volume, settings).volume_ml, 4.0 / 3 * 3.1416 * 7.5 * 7.5 * 7.5, 60);
    for (float& hu : volume.values) hu = hu > 0 ? 900.0F : hu;  // all of bone: there is no soft tissue
    EXPECT_NEAR(segment_skin(volume, settings).volume_ml, 4.0 / 3 * 3.1416 * 7.5 * 7.5 * 7.5, 60);
}

/// Voxels of 2 mm, 121 each way: a ball of 40 mm, and a couch of `thick_mm` under it, `gap_mm` below.
Volume phantom_on_couch(double thick_mm, double gap_mm) {
    Volume volume;
    volume.modality = "CT";
    volume.is_hu = true;
    volume.ct_from_voxel.linear() *= 2;
    volume.ct_from_voxel.translation() = Eigen::Vector3d(-120, -120, -120);
    volume.size = {121, 121, 121};
    for (int k = 0; k < 121; ++k)
        for (int j = 0; j < 121; ++j)
            for (int i = 0; i < 121; ++i) {
                const Eigen::Vector3d p = volume.ct_from_voxel * Eigen::Vector3d(i, j, k);
                const double below = p.y() - 40 - gap_mm;
                const bool couch = below > -1 && below < thick_mm && std::abs(p.x()) < 100;
                volume.values.push_back(p.norm() < 40 || couch ? 100.0F : -1000.0F);
            }
    return volume;
}

TEST(SegmentSkin, APhantomThatMayBeACouchOrLiesOnOneIsDoubted) {
    SkinSettings settings;
    settings.phantom = true;
    const auto warned = [&](const Volume& volume, const char* of) {
        const SkinMask mask = segment_skin(volume, settings);
        return std::any_of(mask.warnings.begin(), mask.warnings.end(),
                           [&](const std::string& w) { return w.find(of) != std::string::npos; });
    };
    const Volume touching = phantom_on_couch(6, -2), larger = phantom_on_couch(40, 10), alone = phantom_on_couch(0, 60);
    EXPECT_TRUE(warned(touching, "reaches the sides")) << "the couch is part of the skin";
    EXPECT_TRUE(warned(larger, "of two large pieces")) << "the couch is the skin";
    EXPECT_TRUE(warned(larger, "reaches the sides"));
    EXPECT_FALSE(warned(alone, "")) << "nothing else is there";
}

TEST(SegmentSkin, AsAPhantomASmallPlateIsTakenAndNothingIsRefusedInItsWords) {
    Volume plate = phantom_on_couch(0, 60);
    for (std::size_t v = 0; v < plate.values.size(); ++v) plate.values[v] = -1000;
    SkinSettings settings;
    settings.phantom = true;
    for (int j = 40; j < 60; ++j)
        for (int i = 40; i < 60; ++i)
            for (const int k : {50, 51}) plate.values[plate.index(i, j, k)] = 200;
    EXPECT_NEAR(segment_skin(plate, settings).volume_ml, 6.4, 0.1);
    settings.threshold = 500;
    try {
        segment_skin(plate, settings);
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find("skin"), std::string::npos) << error.what();
        EXPECT_EQ(error.remedy.find("head"), std::string::npos) << error.remedy;
    }
}

TEST(SegmentSkin, ReportsProgressToTheEnd) {
    ScanOptions options;
    options.spacing_mm = {3, 3, 3};
    const Volume scan = synthetic_scan(options);
    double last = 0;
    bool rises = true;
    const auto watch = [&](double done) {
        rises = rises && done >= last;
        last = done;
    };
    const SkinMask mask = segment_skin(scan, {}, watch);
    EXPECT_EQ(last, 1);
    last = 0;
    triangulate_skin(scan, mask, {}, watch);
    EXPECT_EQ(last, 1);
    EXPECT_TRUE(rises);
}

/// Whether a vertex lies where the scan of `synthetic_scan` ends below.
bool is_below(const Vector3d& p) {
    return p.z() < kCutZ_mm - 0.01;
}

TEST(TriangulateSkin, TakesTheEndOfARoundFieldOfViewForNoSkin) {
    constexpr double kView_mm = 65;  // of the axis; the head is wider behind and at the sides
    Volume scan = bare().scan;
    for (int k = 0; k < scan.size[2]; ++k)
        for (int j = 0; j < scan.size[1]; ++j)
            for (int i = 0; i < scan.size[0]; ++i)
                if ((scan.ct_from_voxel * Vector3d(i, j, k)).head<2>().norm() > kView_mm)
                    scan.values[scan.index(i, j, k)] = -1000;  // as padding is read
    const SkinMask mask = segment_skin(scan);
    const TriangleMesh skin = triangulate_skin(scan, mask);
    std::size_t ends = 0, misplaced = 0, wall = 0, missed = 0;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
        const Vector3d& p = skin.vertices_in_ct[v];
        if (is_below(p)) continue;
        const bool end = skin.flags[v] == kCutPlane, on_wall = std::abs(p.head<2>().norm() - kView_mm) < 1.3,
                   in_head = analytic_head_distance(p) < -4;
        ends += end;
        misplaced += end && !on_wall;
        wall += on_wall && in_head;
        missed += on_wall && in_head && !end;
    }
    EXPECT_GT(wall, 1000U);
    EXPECT_LT(missed, wall / 20);     // where the wall is a narrow strip
    EXPECT_LT(misplaced, ends / 20);  // at its rim
}

TEST(TriangulateSkin, TakesNoSkinForABlankedEdgeWhereAirShowsOneValue) {
    Volume scan = bare().scan;
    for (float& value : scan.values)
        if (value < -940) value = -1000;
    const TriangleMesh skin = triangulate_skin(scan, segment_skin(scan));
    std::size_t ends = 0;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v)
        ends += skin.flags[v] == kCutPlane && !is_below(skin.vertices_in_ct[v]);
    EXPECT_EQ(ends, 0U);
}

}  // namespace
}  // namespace planlight::test
