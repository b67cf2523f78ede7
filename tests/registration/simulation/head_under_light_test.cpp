#include "registration/simulation/serve/head_under_light.h"

#include <gtest/gtest.h>

#include <chrono>

#include "tests/registration/simulation/analytic_volume.h"

// The head of a served room, which knows nothing but the light.
namespace planlight::simulation {
namespace {

using std::chrono::milliseconds;

class HeadUnderLightTest : public testing::Test {
protected:
    const Volume volume_ = test::volume_of_analytic_head();
    SimulatedRig rig_{volume_, {}, [] {
                          RoomSettings settings;
                          settings.preset = Preset::paper;
                          return settings;
                      }()};
    HeadUnderLight projector_{rig_, 20};

    RgbImage dark() const { return {projector_.width(), projector_.height()}; }
    RgbImage plan() const {
        RgbImage picture = dark();
        for (int y = 0; y < picture.height; ++y) picture.at(picture.width / 2, y) = {0, 200, 0};
        return picture;
    }
    RgbImage stripes() const {
        RgbImage picture = dark();
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; x += 2) picture.at(x, y) = {255, 255, 255};
        return picture;
    }
    /// How far the middle of the head is moved by two seconds, mm, while that stands on the monitor.
    double moved_under(const RgbImage& picture) {
        projector_.show(picture, rig_.clock().now() + std::chrono::hours(1));
        return moved();
    }
    double moved() {
        const RigidTransform before = rig_.true_rig_from_ct(rig_.clock().now());
        rig_.wait(milliseconds(2000));
        return (before.translation() - rig_.true_rig_from_ct(rig_.clock().now()).translation()).norm();
    }
};

TEST_F(HeadUnderLightTest, LiesStillUntilThePlanIsLit) {
    EXPECT_EQ(moved(), 0);
    EXPECT_EQ(moved_under(stripes()), 0);
    EXPECT_EQ(moved_under(dark()), 0);
    EXPECT_GT(moved_under(plan()), 1);
}

TEST_F(HeadUnderLightTest, MovesOnWhenTheLightGoesOut) {
    EXPECT_GT(moved_under(plan()), 1);
    EXPECT_GT(moved_under(dark()), 1);
    projector_.go_dark();
    EXPECT_GT(moved(), 1);
}

TEST_F(HeadUnderLightTest, LiesStillForAScan) {
    EXPECT_GT(moved_under(plan()), 1);
    EXPECT_EQ(moved_under(stripes()), 0);
    EXPECT_EQ(moved_under(dark()), 0) << "between two patterns, and after the last";
    EXPECT_GT(moved_under(plan()), 1);
}

TEST_F(HeadUnderLightTest, ASpeedThatIsSetHoldsFromTheNextPicture) {
    projector_.set_speed(0);
    EXPECT_EQ(moved_under(plan()), 0);
    projector_.set_speed(20);
    EXPECT_EQ(moved(), 0);
    EXPECT_GT(moved_under(plan()), 1);
}

}  // namespace
}  // namespace planlight::simulation
