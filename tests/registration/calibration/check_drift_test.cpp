#include "registration/calibration/check_drift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

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
    EXPECT_LT(check.epipolar_px, 0.2);
    EXPECT_LT(check.projector_rms_px, 0.3);
    EXPECT_TRUE(check.remedy.empty());
}

/// The rms of all distances is over the limit then: two wrong partners of 20,000 points made it 0.44 px in a good
/// simulated room.
TEST(CheckDrift, AFewWrongPartnersAreNoMovedCamera) {
    ScanResult scan = scan_from_capture(scanned().shot, scanned().rig);
    auto& points = scan.raw.by_cameras;
    double squares = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % 500 == 0) points[i].epipolar_px = i % 1000 == 0 ? 48 : -41;
        squares += points[i].epipolar_px * points[i].epipolar_px;
    }
    ASSERT_GT(std::sqrt(squares / static_cast<double>(points.size())), DriftLimits{}.epipolar_px);
    const DriftCheck check = check_drift(scan, scanned().rig);
    EXPECT_EQ(check.verdict, Verdict::good) << check.reason;
    EXPECT_LT(check.epipolar_px, 0.2);
}

/// A tenth of a degree puts the light 1.5 mm off at 0.9 m: noticed, and said in mm.
// One figure for `scan` and `check`: that of the points, not of the wrong partners among them.
TEST(CheckDrift, TheUsualEpipolarDistanceIsThatOfNormalNoiseWhateverAFewPointsDo) {
    std::mt19937 random(2);
    std::normal_distribution<double> noise(0, 0.1);
    Triangulation raw;
    EXPECT_EQ(usual_epipolar_px(raw), 0) << "not known";
    for (int i = 0; i < 20000; ++i)
        raw.by_cameras.push_back(
            {Eigen::Vector3d::Zero(), Eigen::Vector2d::Zero(), i % 1000 == 0 ? 50.0 : noise(random)});
    EXPECT_NEAR(usual_epipolar_px(raw), 0.1, 0.003);
}

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
    EXPECT_EQ(check.verdict, Verdict::cameras_moved) << text_of(check.verdict);
    EXPECT_FALSE(check.remedy.empty());
}

TEST(CheckDrift, AZoomedProjectorIsNotTakenForAMovedOne) {
    RigCalibration rig = scanned().rig;
    rig.projector.focal_x *= 1.05;
    rig.projector.focal_y *= 1.05;
    const DriftCheck check = checked(rig);
    EXPECT_NE(check.verdict, Verdict::good);
}

void flip_distortion(CameraModel& device) {
    for (double* k : {&device.k1, &device.k2, &device.k3, &device.p1, &device.p2}) *k = -*k;
}

/// 0.02 degrees are 0.7 px of this camera. So few points are near their lines then that the projector cannot be placed
/// by them.
TEST(CheckDrift, ACameraTurnedByAFiftiethOfADegreeIsNoticed) {
    for (const double degrees : {0.02, -0.02}) {
        RigCalibration rig = scanned().rig;
        rig.right_camera.device_from_rig =
            turned_by(degrees, Eigen::Vector3d::UnitX()) * rig.right_camera.device_from_rig;
        EXPECT_EQ(checked(rig).verdict, Verdict::cameras_moved) << degrees;
    }
}

/// A mild lens the wrong way round is under the noise of a point, but not of a place. It takes a surface over most of
/// the pictures.
TEST(CheckDrift, AFlippedSignOfADistortionIsNoticed) {
    const Room room = paper_room(nearest_of(
        {sphere({120, -40, 400}, 95), plane({120, -40, 400}, Eigen::Vector3d(0.2, 0.1, -1).normalized(), 250)}));
    const ScanCapture shot = capture(room, stripes_of(room));
    for (const int which : {0, 1, 2}) {
        RigCalibration rig = rig_of(room);
        flip_distortion(which == 0 ? rig.left_camera : which == 1 ? rig.right_camera : rig.projector);
        const DriftCheck check = check_drift(scan_from_capture(shot, rig), rig);
        EXPECT_NE(check.verdict, Verdict::good)
            << which << ": k1 off " << check.bent.k1_off << " +- " << check.bent.k1_sigma << ", projector bent "
            << check.bent.projector_px << " px";
        EXPECT_FALSE(check.remedy.empty());
    }
    const DriftCheck good = check_drift(scan_from_capture(shot, rig_of(room)), rig_of(room));
    EXPECT_EQ(good.verdict, Verdict::good) << good.reason;
    EXPECT_LT(std::abs(good.bent.k1_off), 0.05) << good.bent.k1_sigma;
    EXPECT_LT(good.bent.k1_sigma, 0.04);
    EXPECT_LT(good.bent.projector_px, 0.03);
}

/// A patient's head alone: too small to place the projector by it, and still the three devices agree or do not.
TEST(CheckDrift, OfASmallSurfaceAllDevicesTogetherTell) {
    ScanResult scan = scan_from_capture(scanned().shot, scanned().rig);
    scan.resection.reset();
    ASSERT_EQ(scan.rig.verdict, RigState::Verdict::as_calibrated) << scan.rig.sentence;
    const DriftCheck check = check_drift(scan, scanned().rig);
    EXPECT_EQ(check.verdict, Verdict::good) << check.reason;
    EXPECT_NE(check.reason.find("without a sign of it"), std::string::npos) << check.reason;
    scan.rig.hidden_light_mm = 1.5;
    EXPECT_EQ(check_drift(scan, scanned().rig).verdict, Verdict::cannot_tell) << "too much may be hidden";
    scan.rig.hidden_light_mm = 0.3;
    scan.rig.verdict = RigState::Verdict::unknown;
    EXPECT_EQ(check_drift(scan, scanned().rig).verdict, Verdict::cannot_tell);
}

TEST(CheckDrift, NothingInViewCannotTell) {
    ScanCapture dark = scanned().shot;
    for (auto* frames : {&dark.left, &dark.right})
        for (GrayImage& frame : *frames) std::fill(frame.pixels.begin(), frame.pixels.end(), std::uint8_t{10});
    const DriftCheck check = check_drift(scan_from_capture(dark, scanned().rig), scanned().rig);
    EXPECT_EQ(check.verdict, Verdict::cannot_tell);
    EXPECT_FALSE(check.remedy.empty());
}

/// Coarse cells and a missing direction say nothing of the rig: neither that cameras moved nor that too little is in
/// view.
TEST(CheckDrift, LightThatIsReadTooCoarselyCannotTell) {
    ScanResult scan = scan_from_capture(scanned().shot, scanned().rig);
    scan.code_step_px = 20;
    for (auto& point : scan.raw.by_cameras) point.epipolar_px = 2;
    const DriftCheck coarse = check_drift(scan, scanned().rig);
    EXPECT_EQ(coarse.verdict, Verdict::cannot_tell);
    EXPECT_NE(coarse.reason.find("20 projector pixels"), std::string::npos) << coarse.reason;
    StripeSettings columns = stripes_of(scanned().room);
    columns.rows = false;
    const DriftCheck half =
        check_drift(scan_from_capture(capture(scanned().room, columns), scanned().rig), scanned().rig);
    EXPECT_EQ(half.verdict, Verdict::cannot_tell);
    EXPECT_NE(half.reason.find("columns only"), std::string::npos) << half.reason;
    EXPECT_FALSE(half.remedy.empty());
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
    checks = {{0, 0.1, 0.2}, {1, 0.1, 0.3}, {2, 0.1, 0.4}, {3, 0.1, 0}};  // the last did not place the projector
    EXPECT_TRUE(drift_trends(checks).empty());
    checks = {{0, 0.1, 0.2}, {1, 0.2, 0.3}, {2, 0.3, 0.4}};
    EXPECT_TRUE(drift_trends(checks).empty());
}

}  // namespace
}  // namespace planlight
