#include "registration/tracking/camera_lag.h"

#include <gtest/gtest.h>

#include <cmath>

#include "marker_scene.h"

namespace planlight::test {
namespace {

using std::chrono::milliseconds;

constexpr int kEvery_ms = 40, kFrames = 10;

/// The head sways: up to 30 mm/s sideways, and `upright` of that along its height.
RigidTransform head_at(double t_s, double upright) {
    return head_move({0, 0, 0}, {10 * std::sin(3 * t_s), upright * 10 * std::sin(3 * t_s + 0.4), 0}) *
           RigidTransform(Eigen::Translation3d(head_centre()));
}

/// A frame whose left and right pictures show the head at their own moments.
StereoFrame frame_of(const RigCalibration& rig, double left_s, double right_s, double upright, Instant at,
                     std::mt19937& random) {
    StereoFrame frame = render_frame(rig, moved(head_at(left_s, upright), stickers_on_head()), {}, at, random);
    frame.right = render_frame(rig, moved(head_at(right_s, upright), stickers_on_head()), {}, at, random).right;
    return frame;
}

/// `right_later_s`: of each frame by its number.
CameraLag cameras_of(const std::function<double(int)>& right_later_s, double upright = 1) {
    const RigCalibration rig = paper_rig();
    std::mt19937 random(3);
    PatientTracker tracker(rig);
    tracker.set_reference(frame_of(rig, 0, 0, upright, {}, random));
    CameraLag cameras(rig);
    for (int k = 1; k <= kFrames; ++k) {
        const Instant at = milliseconds(k * kEvery_ms);
        const double t = seconds(at);
        tracker.update(frame_of(rig, t, t + right_later_s(k - 1), upright, at, random));
        cameras.add(tracker, at);
    }
    return cameras;
}

TEST(CameraLag, CamerasThatExposeTogetherHaveNone) {
    const CameraLag cameras = cameras_of([](int) { return 0.0; });
    const auto lag = cameras.lag();
    ASSERT_TRUE(lag.known);
    EXPECT_LT(std::abs(lag.right_later_s), 5 * lag.sigma_s + 1e-4);
    EXPECT_LT(std::abs(lag.right_later_s), 0.003);
    EXPECT_TRUE(cameras.odd_frames().empty());
}

TEST(CameraLag, ACameraThatRunsBehindIsMeasured) {
    for (const double later_s : {-0.04, 0.015}) {
        const auto lag = cameras_of([&](int) { return later_s; }).lag();
        ASSERT_TRUE(lag.known) << later_s;
        EXPECT_NEAR(lag.right_later_s, later_s, 0.25 * std::abs(later_s)) << "in part its own mean is taken for usual";
        EXPECT_GT(std::abs(lag.right_later_s), 5 * lag.sigma_s) << later_s;
    }
}

TEST(CameraLag, APictureThatStoodStillIsFound) {
    const auto odd = cameras_of([](int frame) { return frame == 6 ? -0.03 : 0.0; }).odd_frames();
    ASSERT_EQ(odd.size(), 1u);
    EXPECT_EQ(odd.front(), 6u);
}

/// The cameras stand beside each other: their epipolar lines run along the movement.
TEST(CameraLag, AMovementAlongTheLineBetweenTheCamerasTellsNothing) {
    EXPECT_FALSE(cameras_of([](int) { return -0.04; }, 0).lag().known);
}

}  // namespace
}  // namespace planlight::test
