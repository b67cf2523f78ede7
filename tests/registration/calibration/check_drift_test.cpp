#include "registration/calibration/check_drift.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;
using Verdict = DriftCheck::Verdict;

struct Scanned {
    Room room = paper_room(sphere({120, -40, 360}, 95));
    RigCalibration rig = rig_of(room);
    ScanCapture shot = capture(room, stripes_of(room));
};

const Scanned& scanned() {
    static const Scanned s;
    return s;
}

DriftCheck checked(const RigCalibration& rig) {
    return check_drift(scan_from_capture(scanned().shot, rig), rig);
}

RigidTransform turned_by(double degrees, const Eigen::Vector3d& axis) {
    return RigidTransform(Eigen::AngleAxisd(degrees * M_PI / 180, axis));
}

TEST(CheckDrift, AGoodRigIsGood) {
    const DriftCheck check = checked(scanned().rig);
    EXPECT_EQ(check.verdict, Verdict::good) << check.reason;
    EXPECT_LT(check.epipolar_rms_px, 0.2);
    EXPECT_LT(check.projector_rms_px, 0.3);
    EXPECT_TRUE(check.remedy.empty());
}

/// A tenth of a degree puts the light 1.5 mm off at 0.9 m: noticed, and said in mm.
TEST(CheckDrift, AKnockedProjectorIsNoticedAndMeasured) {
    RigCalibration rig = scanned().rig;
    rig.projector.device_from_rig = turned_by(0.1, Eigen::Vector3d::UnitY()) * rig.projector.device_from_rig;
    const DriftCheck check = checked(rig);
    EXPECT_EQ(check.verdict, Verdict::projector_moved) << check.reason;
    EXPECT_NEAR(check.light_off_mm, 900 * 0.1 * M_PI / 180, 0.4);
    EXPECT_LT(check.projector_after_px, 0.3);
    EXPECT_FALSE(check.remedy.empty());
}

/// A turn of the right camera about its line of sight, or up and down, leaves the epipolar lines.
TEST(CheckDrift, AKnockedCameraIsNoticed) {
    RigCalibration rig = scanned().rig;
    rig.right_camera.device_from_rig = turned_by(0.05, Eigen::Vector3d::UnitX()) * rig.right_camera.device_from_rig;
    const DriftCheck check = checked(rig);
    EXPECT_TRUE(check.verdict == Verdict::cameras_moved || check.verdict == Verdict::cannot_tell) << text_of(check.verdict);
    EXPECT_FALSE(check.remedy.empty());
}

TEST(CheckDrift, AZoomedProjectorIsNotTakenForAMovedOne) {
    RigCalibration rig = scanned().rig;
    rig.projector.focal_x *= 1.05;
    rig.projector.focal_y *= 1.05;
    const DriftCheck check = checked(rig);
    EXPECT_NE(check.verdict, Verdict::good);
}

TEST(CheckDrift, NothingInViewCannotTell) {
    ScanCapture dark = scanned().shot;
    for (auto* frames : {&dark.left, &dark.right})
        for (GrayImage& frame : *frames) std::fill(frame.pixels.begin(), frame.pixels.end(), std::uint8_t{10});
    const DriftCheck check = check_drift(scan_from_capture(dark, scanned().rig), scanned().rig);
    EXPECT_EQ(check.verdict, Verdict::cannot_tell);
    EXPECT_FALSE(check.remedy.empty());
}

TEST(DriftTrend, ARisingErrorSaysWhenItReachesItsLimit) {
    std::vector<EarlierCheck> checks;
    for (int day = 0; day < 6; ++day) checks.push_back({day + 0.0, 0.1 + 0.05 * day + 0.004 * (day % 2), 0.2});
    const auto trends = drift_trends(checks);
    ASSERT_EQ(trends.size(), 1u);
    EXPECT_EQ(trends[0].what, "epipolar error");
    EXPECT_NEAR(trends[0].px_per_day, 0.05, 0.003);
    EXPECT_NEAR(trends[0].days_to_limit, (0.4 - 0.35) / 0.05, 0.2);
}

TEST(DriftTrend, NoiseAndFewChecksAreNoTrend) {
    std::vector<EarlierCheck> checks{{0, 0.10, 0.2}, {1, 0.14, 0.2}, {2, 0.11, 0.2}, {3, 0.13, 0.2}, {4, 0.10, 0.2}};
    EXPECT_TRUE(drift_trends(checks).empty());
    checks = {{0, 0.1, 0.2}, {1, 0.2, 0.3}, {2, 0.3, 0.4}};
    EXPECT_TRUE(drift_trends(checks).empty());
}

}  // namespace
}  // namespace planlight
