#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/registration/matching/roc_picture.h"
#include "tests/registration/matching/trial_objects.h"
#include "tests/registration/matching/trial_record.h"
#include "tests/registration/matching/trial_scan.h"
#include "tests/support/test_data.h"

// The trials are only as good as their truth: what they say of a scan is checked on a sphere, where it is known.
namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr double kRadius_mm = 80;

TrialScanSettings clean() {
    TrialScanSettings settings;
    settings.from_in_ct = Vector3d(0.3, -1, 0.2);
    settings.width_mm = 120;
    settings.noise_mm = settings.stray_share = 0;
    settings.seed = 5;
    return settings;
}

/// Distances of the points from the sphere, outwards.
std::vector<double> off_sphere_mm(const TrialScan& scan, double radius_mm = kRadius_mm) {
    std::vector<double> off;
    for (const auto& p : scan.cloud.points_in_rig) off.push_back((scan.rig_from_ct.inverse() * p).norm() - radius_mm);
    return off;
}

TEST(TrialScan, LiesOnTheSurfaceWithItsNormals) {
    const TrialScan scan = trial_scan(sphere_object(kRadius_mm), clean());
    EXPECT_NEAR(static_cast<double>(scan.cloud.size()), 20000, 2500);
    // Edges of 2 mm on 80 mm: a sagitta of 0.006 mm, of the diagonals twice that.
    for (const double off : off_sphere_mm(scan)) ASSERT_NEAR(off, 0, 0.02);
    double worst = 0;
    for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
        const Vector3d outwards = (scan.rig_from_ct.inverse() * scan.cloud.points_in_rig[i]).normalized();
        worst = std::max(worst, (scan.rig_from_ct.linear() * outwards - scan.cloud.normals_in_rig[i]).norm());
    }
    EXPECT_LT(worst, 0.06);  // planes over half a window at the border lean by 3 mm / 80 mm at most
}

TEST(TrialScan, SpoilsAsMuchAsItSays) {
    TrialScanSettings settings = clean();
    settings.noise_mm = 0.5;
    settings.stray_share = 0.3;
    settings.drape_share = 0.25;
    settings.drape_height_mm = 10;
    const TrialScan scan = trial_scan(sphere_object(kRadius_mm), settings);
    const auto n = static_cast<double>(scan.cloud.size());
    EXPECT_NEAR(static_cast<double>(scan.stray_points) / n, 0.3, 0.02);
    EXPECT_NEAR(static_cast<double>(scan.drape_points) / n, 0.25 * 0.7, 0.02);
    std::size_t on = 0, cloth = 0;
    for (const double off : off_sphere_mm(scan)) {
        on += std::abs(off) < 2;
        cloth += off > 4 && off < 40;
    }
    EXPECT_NEAR(static_cast<double>(on) / n, 0.75 * 0.7, 0.03);
    EXPECT_GT(static_cast<double>(cloth) / n, 0.25 * 0.7);  // and some strays
}

TEST(TrialScan, MovesTheSkinByTheSizeGiven) {
    TrialScanSettings settings = clean();
    settings.movement = "waves of 25 mm";
    settings.movement_mm = 1.5;
    double squares = 0;
    const auto off = off_sphere_mm(trial_scan(sphere_object(kRadius_mm), settings));
    for (const double d : off) squares += d * d;
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(off.size())), 1.5, 0.05);
}

TEST(TrialScan, ScalesAndMirrorsTheHead) {
    TrialScanSettings settings = clean();
    settings.scale = 1.04;
    for (const double off : off_sphere_mm(trial_scan(sphere_object(kRadius_mm), settings), 1.04 * kRadius_mm))
        ASSERT_NEAR(off, 0, 0.02);
    // A lump is not its own mirror image: every mirrored point, mirrored back, is one of the scan from the same side.
    settings = clean();
    const TrialSurface lump = lump_object(kRadius_mm, 3);
    const TrialScan still = trial_scan(lump, settings);
    settings.mirrored = true;
    const TrialScan image = trial_scan(lump, settings);
    ASSERT_EQ(still.cloud.size(), image.cloud.size());
    const double middle = lump.middle_in_ct().x();
    for (std::size_t i = 0; i < still.cloud.size(); ++i) {
        Vector3d p = image.rig_from_ct.inverse() * image.cloud.points_in_rig[i];
        p.x() = 2 * middle - p.x();
        ASSERT_LT((p - still.rig_from_ct.inverse() * still.cloud.points_in_rig[i]).norm(), 1e-6);
    }
}

TEST(TrialScan, KnowsHowFarAPoseIsOff) {
    const TrialScan scan = trial_scan(sphere_object(kRadius_mm), clean());
    EXPECT_NEAR(pose_error(scan.rig_from_ct, scan).target_mm, 0, 1e-9);
    RigidTransform turned = scan.rig_from_ct;
    turned.rotate(Eigen::AngleAxisd(0.1, Vector3d::UnitZ()));
    turned.translation() = scan.rig_from_ct * scan.middle_in_ct - turned.linear() * scan.middle_in_ct;
    const PoseError error = pose_error(turned, scan);
    EXPECT_NEAR(error.turn_deg, 5.7296, 1e-3);
    EXPECT_NEAR(error.middle_mm, 0, 1e-9);
    // Targets 60 mm deep, up to 40 mm aside: the farthest from the axis moves by 0.1 rad of 60 to 100 mm.
    EXPECT_GT(error.target_mm, 5.9);
    EXPECT_LT(error.target_mm, 10.1);
}

TEST(TrialLog, GoesOnWhereItWasCut) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "trials.log";
    TrialRecord record;
    record.seed = 17;
    record.kind = "plain";
    record.head = "a head, with a comma";
    record.verdict = 1;
    record.final.target_mm = 0.125;
    record.reasons = "first / second";
    TrialLog(file).add(record);
    std::ofstream(file, std::ios::app) << "18;plain;a head";  // cut while it was written
    const TrialLog log(file);
    ASSERT_EQ(log.records().size(), 1U);
    EXPECT_TRUE(log.holds(17));
    EXPECT_FALSE(log.holds(18));
    EXPECT_EQ(log.records()[0].head, record.head);
    EXPECT_EQ(log.records()[0].final.target_mm, 0.125);
    EXPECT_EQ(log.records()[0].reasons, record.reasons);
    EXPECT_FALSE(log.records()[0].wrong());
}

TEST(Roc, AreaIsTheProbabilityThatARightOneIsHigher) {
    EXPECT_EQ(area_under({"apart", {2, 3}, {0, 1}}), 1);
    EXPECT_EQ(area_under({"the other way", {0, 1}, {2, 3}}), 0);
    EXPECT_EQ(area_under({"alike", {1, 1}, {1}}), 0.5);
    EXPECT_EQ(area_under({"mixed", {1, 3}, {0, 2}}), 0.75);
    EXPECT_EQ(accepted_at({"mixed", {1, 3}, {0, 2}}, 0), 0.5);
    EXPECT_EQ(accepted_at({"mixed", {1, 3}, {0, 2}}, 0.5), 1);
}

}  // namespace
}  // namespace planlight::test
