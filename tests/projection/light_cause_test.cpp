#include "projection/light_cause.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "projection/light_patterns.h"
#include "projection/light_watch.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;

CameraModel device_at(double x_mm, double turn) {
    CameraModel device;
    device.width = 800;
    device.height = 600;
    device.focal_x = device.focal_y = 2000;
    device.centre_x = 399.5;
    device.centre_y = 299.5;
    device.device_from_rig = Eigen::AngleAxisd(turn, Vector3d::UnitY()) * Eigen::Translation3d(-x_mm, 0, 900);
    return device;
}

/// A projector between two cameras, 900 mm before a flat piece of skin that faces them.
RigCalibration rig() {
    RigCalibration rig;
    rig.projector = device_at(0, 0);
    rig.left_camera = device_at(-220, -0.24);
    rig.right_camera = device_at(220, 0.24);
    return rig;
}

/// A scene in which faults are laid on light by their own geometry, frame by frame (25 a second, CHECK in each second).
class Scene {
public:
    double noise_mm = 0.08, speed_mm_s = 0, late_s = 0, depth_mm = 0, seen_share = 1, background = 40;
    Vector3d turn = Vector3d::Zero();  ///< of the projector, radians
    std::array<double, 2> jump_mm{};
    int slipped = -1;
    bool pose = true;

    std::vector<LightFacts> run(Instant duration, std::vector<LightFacts> before = {}) {
        const Instant from = before.empty() ? Instant{} : before.back().at + 40ms;
        bool first = true;
        for (Instant at = from; at < from + duration; at += 40ms) {
            before.push_back(frame(at));
            if (first) before.back().jump_mm = {jump_mm[0], jump_mm[1]};
            first = false;
        }
        return before;
    }

private:
    /// To and fro along x and y; still before it moves.
    RigidTransform pose_at(Instant at) const {
        const double t = seconds(at), way_mm = speed_mm_s / 3;
        RigidTransform rig_from_ct = RigidTransform::Identity();
        rig_from_ct.translation() = way_mm * Vector3d(std::sin(3 * t), std::cos(3 * t) - 1, 0);
        return rig_from_ct;
    }
    LightFacts frame(Instant at) {
        LightFacts facts;
        facts.at = at;
        facts.pose = pose;
        facts.rig_from_ct = pose_at(at);
        facts.jump_mm = {0.0, 0.0};
        facts.slipped_marker = slipped;
        facts.slipped_mm = slipped >= 0 ? 1 : 0;
        for (int k = 6; k >= 0; --k) {
            const Instant lit = at - 20ms - k * 40ms;
            facts.shown.push_back({lit, pose_at(lit)});  // drawn for the moment it was to be light
        }
        if (!pose || (at / 40ms) % 2 != 0) return facts;
        std::normal_distribution<double> noise(0, noise_mm);
        const RigidTransform drawn = pose_at(drawn_for(facts));
        for (int i = 0; i < 40; ++i) {
            SeenSegment segment;
            const double angle = i * 0.7;
            segment.p_in_ct = {40 * std::cos(i * 2.1), 30 * std::sin(i * 1.3), 0};
            segment.normal_in_ct = -Vector3d::UnitZ();
            segment.sideways_in_ct = {std::cos(angle), std::sin(angle), 0};
            segment.item = i / 10;
            segment.sigma_mm = 0.1;
            segment.seen = i < 40 * seen_share;
            ++facts.expected;
            facts.seen += segment.seen;
            const Vector3d p = facts.rig_from_ct * segment.p_in_ct + Vector3d(0, 0, 900);
            const Vector3d turned = turn.cross(p) - turn.cross(p).z() / p.z() * p;
            const double aside =
                aside_mm(segment, drawn, facts.rig_from_ct, rig().projector) + turned.dot(segment.sideways_in_ct);
            // A light `depth_mm` before the skin is seen aside by each camera, the other way round.
            for (std::size_t c = 0; c < 2; ++c)
                segment.by_camera_mm[c] =
                    aside + noise(random_) + (c == 0 ? 1 : -1) * 220.0 / 900 * depth_mm * segment.sideways_in_ct.x();
            segment.off_mm = (*segment.by_camera_mm[0] + *segment.by_camera_mm[1]) / 2;
            facts.segments.push_back(segment);
        }
        facts.background = background;
        return facts;
    }
    Instant drawn_for(const LightFacts& facts) const {
        Instant drawn = facts.shown.front().lit_from;
        for (const ShownPicture& picture : facts.shown)
            if (picture.lit_from + from_seconds(late_s) <= facts.at) drawn = picture.lit_from;
        return drawn;
    }
    std::mt19937 random_{1};
};

std::vector<LightCause> causes_of(const std::vector<LightFacts>& facts) {
    LightWatch watch(rig());
    for (const LightFacts& frame : facts) watch.add(frame);
    return watch.causes();
}

TEST(LightCause, GoodLightHasNone) {
    Scene still, moving;
    moving.speed_mm_s = 30;
    EXPECT_TRUE(causes_of(still.run(5s)).empty());
    EXPECT_TRUE(causes_of(moving.run(5s)).empty()) << "the light's lag behind the head is told by the pictures";
}

TEST(LightCause, LightThatGoesWithTheVelocityIsLate) {
    Scene scene;
    scene.speed_mm_s = 20;
    scene.late_s = 0.03;
    const auto causes = causes_of(scene.run(2s));
    ASSERT_FALSE(causes.empty());
    EXPECT_EQ(causes.front().fault, LightFault::late_picture) << causes.front().sentence();
    // Frames 20 ms after each picture, every 40 ms: any delay from 20 to 60 ms shows the same picture.
    EXPECT_LE(causes.front().low, 30);
    EXPECT_GE(causes.front().high, 30);
}

TEST(LightCause, ALateLightOnAHeadAtRestIsNoFault) {
    Scene scene;
    scene.late_s = 0.05;
    EXPECT_TRUE(causes_of(scene.run(3s)).empty());
}

TEST(LightCause, AProjectorTurnedByATwentiethOfADegreeIsSaidToHaveMoved) {
    for (const double speed : {0.0, 20.0}) {
        Scene scene;
        scene.speed_mm_s = speed;
        const auto before = scene.run(2s);
        scene.turn = 0.05 * std::numbers::pi / 180 * Vector3d(0.6, 0.8, 0);
        const auto causes = causes_of(scene.run(700ms, before));
        ASSERT_FALSE(causes.empty()) << speed;
        EXPECT_EQ(causes.front().fault, LightFault::projector_moved) << causes.front().sentence();
        EXPECT_NEAR(causes.front().size, 0.785 / std::sqrt(2), 0.15) << "0.785 mm, of which the sides see a half";
    }
}

TEST(LightCause, TheCameraWhoseDiscsJumpedMoved) {
    Scene scene;
    const auto before = scene.run(2s);
    scene.turn = 0.04 * std::numbers::pi / 180 * Vector3d(0, 1, 0);  // the light follows the pose that is wrong now
    scene.jump_mm = {0.05, 0.8};
    const auto causes = causes_of(scene.run(700ms, before));
    ASSERT_FALSE(causes.empty());
    EXPECT_EQ(causes.front().fault, LightFault::right_camera_moved) << causes.front().sentence();
    scene.jump_mm = {0.8, 0.7};  // a head that jerked is seen by both
    const auto both = causes_of(scene.run(700ms, before));
    ASSERT_FALSE(both.empty());
    EXPECT_EQ(both.front().fault, LightFault::projector_moved);
}

TEST(LightCause, CamerasThatAgreeOnNoPoseAfterAJumpAreNamed) {
    Scene scene;
    const auto before = scene.run(2s);
    scene.jump_mm = {0.9, 0.1};
    scene.pose = false;
    const auto causes = causes_of(scene.run(400ms, before));
    ASSERT_FALSE(causes.empty());
    EXPECT_EQ(causes.front().fault, LightFault::left_camera_moved);
    Scene covered;  // without a jump the markers are covered: nothing of the light is known
    covered.pose = false;
    EXPECT_TRUE(causes_of(covered.run(400ms, before)).empty());
}

TEST(LightCause, ASlippedMarkerIsNamedAndTheLightIsRight) {
    Scene scene;
    scene.slipped = 4;
    const auto causes = causes_of(scene.run(1s));
    ASSERT_EQ(causes.size(), 1U);
    EXPECT_EQ(causes.front().fault, LightFault::marker_slipped);
    EXPECT_EQ(causes.front().marker, 4);
    EXPECT_FALSE(causes.front().light_is_wrong);
}

TEST(LightCause, SkinAtAnotherDepthThanTheMarkersSay) {
    Scene scene;
    scene.depth_mm = 1;
    const auto causes = causes_of(scene.run(2s));
    ASSERT_FALSE(causes.empty());
    EXPECT_EQ(causes.front().fault, LightFault::markers_moved) << causes.front().sentence();
    EXPECT_NEAR(causes.front().size, 1, 0.15);
}

TEST(LightCause, NoLightIsAnotherPictureOrNone) {
    Scene scene;
    const auto before = scene.run(2s);
    scene.seen_share = 0;
    auto causes = causes_of(scene.run(600ms, before));
    ASSERT_FALSE(causes.empty());
    EXPECT_EQ(causes.front().fault, LightFault::no_picture);
    scene.background = 90;
    causes = causes_of(scene.run(600ms, before));
    ASSERT_FALSE(causes.empty());
    EXPECT_EQ(causes.front().fault, LightFault::other_picture);
    scene.seen_share = 0.3;
    scene.background = 40;
    causes = causes_of(scene.run(600ms, before));
    ASSERT_FALSE(causes.empty());
    EXPECT_EQ(causes.front().fault, LightFault::partly_covered) << "and the rest of the light is where it belongs";
    EXPECT_EQ(causes.size(), 1U);
}

TEST(LightCause, EveryCauseHasWordsAndARemedy) {
    for (int f = 0; f <= static_cast<int>(LightFault::light_off); ++f) {
        LightCause cause;
        cause.fault = static_cast<LightFault>(f);
        cause.size = 1;
        EXPECT_FALSE(cause.headline().empty());
        EXPECT_EQ(cause.sentence().back(), '.');
        EXPECT_EQ(cause.remedy().back(), '.');
    }
}

TEST(LightCause, LightFoundFarAsideIsNotCalledDarkOrCovered) {
    for (const double share : {0.0, 0.3}) {
        Scene scene;
        scene.seen_share = share;
        auto facts = scene.run(2s);
        for (LightFacts& f : facts)
            if (f.expected > 0) f.far_mm = 5;
        const auto causes = causes_of(facts);
        ASSERT_FALSE(causes.empty());
        EXPECT_EQ(causes.front().fault, LightFault::light_off);
        EXPECT_DOUBLE_EQ(causes.front().size, 5);
        for (const LightCause& cause : causes) {
            EXPECT_NE(cause.fault, LightFault::no_picture);
            EXPECT_NE(cause.fault, LightFault::partly_covered);
        }
    }
}

}  // namespace
}  // namespace planlight
