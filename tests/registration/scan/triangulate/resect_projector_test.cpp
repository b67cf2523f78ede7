#include "registration/scan/triangulate/resect_projector.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;

const Eigen::Vector3d kCentre(120, -40, 360);

struct Fixture {
    Room room;
    RigCalibration rig;
    ScanCapture shot;
    DecodedView left, right;
};

const Fixture& scanned() {
    static const Fixture f = [] {
        Fixture g{paper_room(sphere(kCentre, 95)), {}, {}, {}, {}};
        g.rig = rig_of(g.room);
        g.shot = capture(g.room, stripes_of(g.room));
        g.left = decode_stripes(g.shot.left, g.shot.stripes);
        g.right = decode_stripes(g.shot.right, g.shot.stripes);
        return g;
    }();
    return f;
}

/// A projector that was knocked after its calibration.
RigCalibration knocked(const Eigen::Vector3d& turn, const Eigen::Vector3d& shift_mm) {
    RigCalibration rig = scanned().rig;
    Eigen::Matrix<double, 6, 1> twist;
    twist << turn, shift_mm;
    rig.projector.device_from_rig = transform_from_twist(twist) * rig.projector.device_from_rig;
    return rig;
}

/// How far the light lands from where it is wanted, over the lit points: rms in projector pixels against the truth.
double display_error_px(const CameraModel& projector) {
    const Truth truth = truth_of(scanned().room, scanned().room.left);
    double squares = 0, n = 0;
    for (std::size_t i = 0; i < truth.code.size(); i += 37) {
        if (std::isnan(truth.code[i].x())) continue;
        squares += (project(projector, truth.point[i]).value() - truth.code[i]).squaredNorm();
        n += 1;
    }
    return std::sqrt(squares / n);
}

TEST(ResectProjector, AKnockedProjectorIsFoundAgain) {
    const RigCalibration rig = knocked({0.0015, -0.002, 0.001}, {1.5, -0.5, 1});  // 0.2 degrees, 2 mm
    ASSERT_GT(display_error_px(rig.projector), 3);
    const auto found = resect_projector(triangulate(scanned().left, scanned().right, rig), rig);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->believable);
    EXPECT_GT(found->rms_before_px, 1);
    EXPECT_LT(found->rms_after_px, 0.1);
    EXPECT_LT(display_error_px(found->projector), 0.05);  // 0.02 mm on the skin
    EXPECT_NEAR(found->turned, 0.0027, 0.0005);
}

TEST(ResectProjector, ASoundProjectorIsLeftAlone) {
    const auto found = resect_projector(triangulate(scanned().left, scanned().right, scanned().rig), scanned().rig);
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->believable);  // nothing to gain
    EXPECT_LT(found->moved_mm, 0.5);
    EXPECT_LT(display_error_px(found->projector), 0.05);
}

TEST(ResectProjector, AShiftedLensNeedsTheIntrinsics) {
    RigCalibration rig = scanned().rig;
    rig.projector.centre_x += 4;
    rig.projector.focal_x *= 1.004;
    rig.projector.focal_y *= 1.004;
    ResectionSettings free;
    free.free_intrinsics = true;
    const auto found = resect_projector(triangulate(scanned().left, scanned().right, rig), rig, free);
    ASSERT_TRUE(found);
    EXPECT_LT(display_error_px(found->projector), 0.05);
    EXPECT_LT(found->rms_after_px, 0.1);
}

TEST(ResectProjector, AProjectorThatWasMovedIsNotAbsorbed) {
    const RigCalibration rig = knocked({0.01, 0.05, 0}, {25, 0, 0});
    const auto found = resect_projector(triangulate(scanned().left, scanned().right, rig), rig);
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->believable);
    EXPECT_LT(display_error_px(found->projector), 0.05);  // found all the same, for a person to accept
}

TEST(ResectProjector, TooFewPointsAreNoAnswer) {
    EXPECT_FALSE(resect_projector({}, scanned().rig));
    Triangulation raw = triangulate(scanned().left, scanned().right, scanned().rig);
    raw.by_cameras.resize(300);
    EXPECT_FALSE(resect_projector(raw, scanned().rig));
}

TEST(ResectProjector, TheScanUsesItForPointsOfOneCamera) {
    const RigCalibration rig = knocked({0.0004, -0.0006, 0.0003}, {0.3, -0.2, 0.2});
    ScanSettings as_calibrated;
    as_calibrated.use_resection = false;
    const ScanResult without = scan_from_capture(scanned().shot, rig, as_calibrated),
                     with = scan_from_capture(scanned().shot, rig);
    EXPECT_FALSE(without.resection_used);
    ASSERT_TRUE(with.resection_used);
    EXPECT_GT(with.raw.two_view,
              without.raw.two_view + 300);  // the gate drops what the knocked projector would misplace
    double squares = 0, n = 0;
    for (std::size_t i = 0; i < with.raw.cloud.size(); ++i) {
        if (with.raw.seen[i] == Triangulation::Seen::both) continue;
        squares += std::pow((with.raw.cloud.points_in_rig[i] - kCentre).norm() - 95, 2);
        n += 1;
    }
    EXPECT_LT(std::sqrt(squares / n), 0.25);  // at the sphere's steep rims, where one camera alone sees
}

}  // namespace
}  // namespace planlight
