#include "registration/calibration/pose_guide.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "registration/calibration/calibrate_rig.h"
#include "registration/calibration/draw_board.h"
#include "tests/registration/calibration/ideal_board.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegrees = 180 / std::numbers::pi;

/// The board's middle at `at` (rig), its face turned by `tilt` (as `BoardStance::tilt`, but against the rig's z axis).
RigidTransform posed(const BoardSpec& board, const Vector2d& tilt, const Vector3d& at, double turn = 0) {
    RigidTransform pose = RigidTransform::Identity();
    const double angle = tilt.norm();
    // A face that looks along -z is turned to the right by a turn about -y.
    const Vector3d axis = angle > 0 ? Vector3d(Vector3d(tilt.y(), -tilt.x(), 0) / angle) : Vector3d(1, 0, 0);
    pose.linear() = (Eigen::AngleAxisd(angle, axis) * Eigen::AngleAxisd(turn, Vector3d::UnitZ())).toRotationMatrix();
    pose.translation() = at - pose.linear() * Vector3d(board.width_mm() / 2, board.height_mm() / 2, 0);
    return pose;
}

const Vector3d kPlace(0, 0, 900);

/// A person's hands: the board in a pose, seen as live pictures would show it.
struct Scene {
    test::IdealRoom room = test::ideal_room();
    Instant now = 0s;

    PoseObservation observation(const RigidTransform& pose) {
        room.rig_from_board = {pose};
        room.noise_px = 0.03;
        return room.observe(static_cast<unsigned>(now.count() / 1'000'000) + 1)[0];
    }
    BoardSighting sighting(const RigidTransform& pose) {
        const PoseObservation seen = observation(pose);
        BoardSighting sighting;
        for (const auto& [view, camera] :
             {std::pair{&sighting.left, &seen.left}, std::pair{&sighting.right, &seen.right}}) {
            *view = {camera->width, camera->height, camera->corners, 200, 110, 0, 0.8};
            if (!spans_a_plane(view->corners, room.board)) view->corners = {};
        }
        sighting.at = now;
        now += 40ms;
        return sighting;
    }
    /// Held there for a second.
    PoseAdvice hold(PoseGuide& guide, const RigidTransform& pose,
                    const std::function<void(BoardSighting&)>& spoil = {}) {
        PoseAdvice advice;
        for (int i = 0; i < 25; ++i) {
            BoardSighting seen = sighting(pose);
            if (spoil) spoil(seen);
            advice = guide.look(seen);
        }
        return advice;
    }
    PoseAdvice hold_and_take(PoseGuide& guide, const RigidTransform& pose) {
        const PoseAdvice advice = hold(guide, pose);
        if (advice.capture) guide.add(observation(pose), room.rig.projector.width, room.rig.projector.height);
        return advice;
    }
};

GrayImage blurred(const GrayImage& picture, double sigma) {
    GrayImage out = picture;
    const cv::Mat in(picture.height, picture.width, CV_8UC1, const_cast<std::uint8_t*>(picture.pixels.data()));
    cv::Mat to(out.height, out.width, CV_8UC1, out.pixels.data());
    cv::GaussianBlur(in, to, {}, sigma);
    return out;
}

Vector2d tilted(double degrees, double towards_degrees) {
    return degrees / kDegrees * Vector2d(std::cos(towards_degrees / kDegrees), std::sin(towards_degrees / kDegrees));
}

/// A person does not hold a board to the degree: five are enough to say which edge is to come nearer, and how far. The
/// cameras are known by nothing but the board.
TEST(BoardStance, IsToldWithinFiveDegreesByCamerasOfWhichNothingIsKnown) {
    for (const double tilt : {15.0, 25.0, 38.0})
        for (double towards = 0; towards < 360; towards += 45) {
            Scene scene;
            const BoardSighting seen = scene.sighting(posed(scene.room.board, tilted(tilt, towards), kPlace, 0.4));
            const CameraModel left = guessed_camera({seen.left.corners}, scene.room.board, 744, 576),
                              right = guessed_camera({seen.right.corners}, scene.room.board, 744, 576);
            const auto stance = stance_of(seen.left.corners, seen.right.corners, left, right, scene.room.board);
            ASSERT_TRUE(stance);
            EXPECT_LT((stance->tilt - tilted(tilt, towards)).norm() * kDegrees, 5) << tilt << " towards " << towards;
        }
}

/// With the true lenses the distance is that of the board, to what corners of 0.03 px leave open.
TEST(BoardStance, DistanceAndSteepnessAreThoseOfTheRoom) {
    Scene scene;
    const RigidTransform pose = posed(scene.room.board, tilted(30, 0), kPlace);
    const BoardSighting seen = scene.sighting(pose);
    const auto stance = stance_of(seen.left.corners, seen.right.corners, scene.room.rig.left_camera,
                                  scene.room.rig.right_camera, scene.room.board);
    ASSERT_TRUE(stance);
    const double left = (kPlace - scene.room.rig.left_camera.centre_in_rig()).norm(),
                 right = (kPlace - scene.room.rig.right_camera.centre_in_rig()).norm();
    EXPECT_NEAR(stance->distance_mm, (left + right) / 2, 1);
    const Vector3d face = pose.linear().col(2);
    const double steepest =
        std::max(std::acos(face.dot((kPlace - scene.room.rig.left_camera.centre_in_rig()).normalized())),
                 std::acos(face.dot((kPlace - scene.room.rig.right_camera.centre_in_rig()).normalized())));
    EXPECT_NEAR(stance->steepest, steepest, 0.01);
}

TEST(PoseGuide, ABoardThatLiesWellAndStillIsCaptured) {
    Scene scene;
    PoseGuide guide(scene.room.board);
    const PoseAdvice advice = scene.hold(guide, posed(scene.room.board, tilted(25, 20), kPlace));
    EXPECT_EQ(advice.fault, PoseFault::none) << advice.why;
    EXPECT_TRUE(advice.capture);
    EXPECT_EQ(advice.in_light, "HOLD STILL");
}

/// A tenth of a millimetre a frame is a fifth of a pixel: each step is under the bound, the way is not.
TEST(PoseGuide, ABoardThatCreepsIsNotCaptured) {
    Scene scene;
    PoseGuide guide(scene.room.board);
    for (int i = 0; i < 60; ++i)
        EXPECT_FALSE(
            guide.look(scene.sighting(posed(scene.room.board, tilted(25, 20), kPlace + Vector3d(0.1 * i, 0, 0))))
                .capture);
}

/// Each is refused for what it is, with a reason and something to do; nothing of it is captured.
TEST(PoseGuide, BadPosesAreRefusedAtOnceEachForItsReason) {
    Scene scene;
    PoseGuide guide(scene.room.board);
    const RigidTransform good = posed(scene.room.board, tilted(25, 20), kPlace);
    ASSERT_TRUE(scene.hold_and_take(guide, good).capture);
    const auto refused = [&](PoseFault fault, const RigidTransform& pose,
                             const std::function<void(BoardSighting&)>& spoil = {}) {
        const PoseAdvice advice = scene.hold(guide, pose, spoil);
        EXPECT_EQ(advice.fault, fault) << text_of(fault) << ", but: " << advice.why;
        EXPECT_FALSE(advice.capture);
        EXPECT_FALSE(advice.why.empty());
        EXPECT_FALSE(advice.what.empty());
        EXPECT_FALSE(advice.in_light.empty());
    };
    const RigidTransform other = posed(scene.room.board, tilted(25, 110), kPlace);
    const BoardSpec& board = scene.room.board;
    refused(PoseFault::alike, posed(board, tilted(27, 22), kPlace + Vector3d(8, 0, 0)));
    refused(PoseFault::flat_on, posed(board, tilted(3, 20), kPlace));
    refused(PoseFault::aslant, posed(board, tilted(66, 90), kPlace));
    refused(PoseFault::too_far, posed(board, tilted(25, 110), kPlace * 1.4));
    refused(PoseFault::too_near, posed(board, tilted(25, 110), kPlace * 0.7));
    refused(PoseFault::not_seen, other, [](BoardSighting& s) { s.left.corners = s.right.corners = {}; });
    refused(PoseFault::one_camera, other, [](BoardSighting& s) { s.right.corners = {}; });
    refused(PoseFault::in_part, other, [](BoardSighting& s) {
        s.left.corners.ids.resize(12);
        s.left.corners.pixels.resize(12);
    });
    refused(PoseFault::too_bright, other, [](BoardSighting& s) { s.right.saturated_share = 0.2; });
    refused(PoseFault::too_dark, other, [](BoardSighting& s) { s.left.contrast_grey = 6; });
    refused(PoseFault::blurred, other, [](BoardSighting& s) { s.right.blur_px = 4; });
}

/// The words name the edge that must come nearer, and a pose that follows them is one that was wanted.
TEST(PoseGuide, WhoFollowsTheWordsIsDoneInTenPosesOrFewer) {
    Scene scene;
    PoseGuide guide(scene.room.board);
    const std::array<std::pair<const char*, double>, 4> edges{
        {{"left", 0}, {"right", 180}, {"upper", 90}, {"lower", 270}}};
    int looks = 0;
    for (; looks < 20 && !guide.done(0.01); ++looks) {
        const PoseAdvice advice = scene.hold(guide, posed(scene.room.board, tilted(2, 0), kPlace));
        ASSERT_EQ(advice.fault, PoseFault::flat_on);
        double towards = -1;
        for (const auto& [word, degrees] : edges)
            if (advice.what.find(std::string(word) + " edge") != std::string::npos) towards = degrees;
        ASSERT_GE(towards, 0) << advice.what;
        const double nearer = advice.what.find("nearer, by") != std::string::npos     ? 50
                              : advice.what.find("farther away") != std::string::npos ? -50
                                                                                      : 0;
        const RigidTransform pose = posed(scene.room.board, tilted(22 + looks, towards + 7 * looks),
                                          kPlace + Vector3d(8 * (looks % 3), -6 * (looks % 2), -nearer), 0.2 * looks);
        const PoseAdvice taken = scene.hold_and_take(guide, pose);
        EXPECT_TRUE(taken.capture) << taken.why;
    }
    EXPECT_LE(guide.poses(), 10U);
    EXPECT_TRUE(guide.wanted().empty()) << guide.wanted().front();
    for (const int poses : guide.coverage().by_edge) EXPECT_GE(poses, 1);
}

/// Good poses of any kind are taken: none of forty random useful ones is refused for anything but its likeness.
TEST(PoseGuide, UsefulPosesAreNotRefused) {
    std::mt19937 random(7);
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    Scene scene;
    PoseGuideSettings settings;
    settings.most_poses = 100;
    PoseGuide guide(scene.room.board, settings);
    for (int i = 0; i < 40; ++i) {
        const PoseAdvice advice = scene.hold_and_take(
            guide, posed(scene.room.board, tilted(between(14, 36), between(0, 360)),
                         kPlace + Vector3d(between(-15, 15), between(-15, 15), between(-60, 60)), between(0, 6.28)));
        EXPECT_TRUE(advice.fault == PoseFault::none || advice.fault == PoseFault::alike ||
                    advice.fault == PoseFault::in_part)
            << text_of(advice.fault) << ": " << advice.why;
    }
    EXPECT_GE(guide.poses(), 25U);
}

/// A prediction that is not good enough is waited for, but not for ever.
TEST(PoseGuide, EndsByThePredictionOrByTheMostPoses) {
    Scene scene;
    PoseGuide guide(scene.room.board);
    for (int i = 0; guide.poses() < 12 && i < 40; ++i) {
        EXPECT_FALSE(guide.done(5.0));
        scene.hold_and_take(guide, posed(scene.room.board, tilted(20 + i % 3 * 6, 35 * i),
                                         kPlace + Vector3d(0, 0, 40 * std::sin(2.0 * i)), 0.3 * i));
    }
    EXPECT_EQ(guide.poses(), 12U);
    EXPECT_TRUE(guide.done(5.0));
    EXPECT_TRUE(guide.done(std::nullopt));
}

/// Once the projector is known, a board beside its light is not captured.
TEST(PoseGuide, ABoardBesideTheLightIsRefusedOnceTheProjectorIsKnown) {
    Scene scene;
    PoseGuide guide(scene.room.board);
    const RigidTransform beside = posed(scene.room.board, tilted(25, 0), kPlace + Vector3d(0, 0, 0));
    EXPECT_EQ(scene.hold(guide, beside).fault, PoseFault::none);
    RigEstimate rig;
    rig.devices = {scene.room.rig.left_camera, scene.room.rig.right_camera, scene.room.rig.projector};
    rig.devices[2]->centre_x += 500;  // it shines elsewhere
    guide.use_rig(rig);
    EXPECT_EQ(scene.hold(guide, beside).fault, PoseFault::beside_light);
}

/// The printed board, large as a camera sees it, blurred: sigma comes back to a fifth, the print's greys to two.
TEST(BoardView, MeasuresBlurAndGreysOfTheBoard) {
    const BoardSpec board = parse_board("charuco 10x7 25 mm");
    const GrayImage print = draw_board(board, 56);
    GrayImage picture(print.width + 120, print.height + 120, 200);
    for (int y = 0; y < print.height; ++y)
        for (int x = 0; x < print.width; ++x)
            picture.at(x + 60, y + 60) = static_cast<std::uint8_t>(print.at(x, y) * 200 / 255);
    for (const double sigma : {1.0, 1.6}) {
        const GrayImage seen = blurred(picture, sigma);
        const BoardView view = look_at_board(seen, board);
        ASSERT_GE(view.corners.size(), 40U);
        EXPECT_NEAR(view.blur_px, sigma, 0.2 * sigma);
        EXPECT_NEAR(view.paper_grey, 200, 4);
        EXPECT_NEAR(view.contrast_grey, 200 - 200 * 102 / 255, 6);
        EXPECT_EQ(view.saturated_share, 0);
    }
    EXPECT_EQ(look_at_board(GrayImage(640, 480, 90), board).corners.size(), 0U);
}

}  // namespace
}  // namespace planlight
