#include "app/live/camera_watch.h"

#include <gtest/gtest.h>

#include "tests/registration/devices/scripted_camera.h"

namespace planlight {
namespace {

using std::chrono::milliseconds;
using test::ScriptedCamera;
using test::SetClock;

/// Bars of `width` pixels, 60 and 180.
GrayImage bars(int width) {
    GrayImage picture(160, 120, 60);
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 160; ++x)
            if (x / width % 2 == 1) picture.at(x, y) = 180;
    return picture;
}

struct CameraWatchTest : ::testing::Test {
    FrameBell bell;
    SetClock clock;
    ScriptedCamera left{"Left camera", bell, 160, 120}, right{"Right camera", bell, 160, 120};
    PairSettings pairs;
    CameraWatch watch{left, right, clock, pairs};
};

TEST_F(CameraWatchTest, BeforeTheFirstPictureNothingIsClaimed) {
    left.says({"it cannot switch off its gamma"});
    watch.look();
    const WatchedRoom room = watch.state();
    EXPECT_FALSE(room.left.picture);
    EXPECT_FALSE(room.apart_ms);
    EXPECT_FALSE(room.together());
    EXPECT_EQ(room.left.notes.size(), 1U);
}

TEST_F(CameraWatchTest, TheBestSharpnessStaysUntilItIsForgotten) {
    left.expose(0, bars(4));
    watch.look();
    const double sharp = watch.state().left.sharpness;
    EXPECT_GT(sharp, 0);
    left.expose(40, bars(20));
    watch.look();
    EXPECT_LT(watch.state().left.sharpness, sharp) << "fewer edges";
    EXPECT_EQ(watch.state().left.best_sharpness, sharp);
    watch.forget_best();
    left.expose(80, bars(20));
    watch.look();
    EXPECT_EQ(watch.state().left.best_sharpness, watch.state().left.sharpness);
}

TEST_F(CameraWatchTest, TellsRateLossExposureAndWhatIsClipped) {
    GrayImage picture = bars(8);
    for (int x = 0; x < 160; ++x) picture.at(x, 0) = 255;
    for (int i = 0; i <= 50; ++i) {
        clock.t = milliseconds(40 * i);
        left.expose(40.0 * i, picture);
        if (i == 7) left.frames().count_incomplete();
        watch.look();
    }
    const WatchedCamera seen = watch.state().left;
    EXPECT_NEAR(seen.frames_hz, 25, 0.5);
    EXPECT_EQ(seen.received, 51U);
    EXPECT_EQ(seen.lost, 1U);
    EXPECT_DOUBLE_EQ(seen.exposure_ms, 10);
    EXPECT_DOUBLE_EQ(seen.clipped.too_bright, 1 / 120.0);
    EXPECT_EQ(seen.clipped.too_dark, 0);
}

TEST_F(CameraWatchTest, TellsHowFarTheExposuresAreApartWhetherTheyAreOneOrNot) {
    for (int i = 0; i < 5; ++i) {
        left.expose(40.0 * i, bars(8));
        right.expose(40.0 * i + 0.3, bars(8));
        watch.look();
    }
    EXPECT_NEAR(*watch.state().apart_ms, 0.3, 1e-6);
    EXPECT_NEAR(watch.state().allowed_ms, 1, 1e-6) << "a tenth of the exposure";
    EXPECT_TRUE(watch.state().together());
    for (int i = 5; i < 40; ++i) {
        left.expose(40.0 * i, bars(8));
        right.expose(40.0 * i - 15, bars(8));
        watch.look();
    }
    EXPECT_NEAR(*watch.state().apart_ms, -15, 1e-6);
    EXPECT_FALSE(watch.state().together());
}

TEST_F(CameraWatchTest, ACameraThatFailedIsSaidAndTheOtherGoesOn) {
    left.expose(0, bars(8));
    right.expose(0, bars(8));
    watch.look();
    left.frames().fail({"nothing came from it for 500 ms", "Look at its cable."});
    right.expose(40, bars(4));
    watch.look();
    ASSERT_TRUE(watch.state().left.fault);
    EXPECT_TRUE(watch.state().left.picture) << "the last one stays";
    EXPECT_FALSE(watch.state().right.fault);
    EXPECT_GT(watch.state().right.sharpness, watch.state().left.sharpness);
}

}  // namespace
}  // namespace planlight
