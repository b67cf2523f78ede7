#include "registration/devices/paired_cameras.h"

#include <gtest/gtest.h>

#include <functional>

#include "planning_io/types/error.h"
#include "tests/registration/devices/scripted_camera.h"

namespace planlight {
namespace {

using std::chrono::milliseconds;
using test::ScriptedCamera;

/// Every look at the clock takes a millisecond; at one of them something may happen.
struct RunningClock final : Clock {
    mutable Instant t{};
    mutable int looks = 0;
    int happens_at = 0;  ///< which look, from 1; 0: none
    std::function<void()> happens;
    Instant now() const override {
        if (++looks == happens_at) happens();
        return t += milliseconds(1);
    }
};

struct PairedCamerasTest : ::testing::Test {
    FrameBell bell;
    RunningClock clock;
    ScriptedCamera* left = nullptr;
    ScriptedCamera* right = nullptr;
    std::unique_ptr<PairedCameras> cameras;
    void SetUp() override {
        auto l = std::make_unique<ScriptedCamera>("left camera", bell),
             r = std::make_unique<ScriptedCamera>("right camera", bell);
        left = l.get();
        right = r.get();
        cameras = std::make_unique<PairedCameras>(std::move(l), std::move(r), bell, clock);
    }
    std::string refusal(milliseconds patience = milliseconds(30)) {
        try {
            cameras->grab({}, patience);
        } catch (const DeviceError& error) {
            return error.what();
        }
        return {};
    }
};

TEST_F(PairedCamerasTest, TheFirstPairThatBeginsAfterAMomentIsTakenWhateverComesFirst) {
    right->expose(100.2, 11);
    right->expose(140.2, 12);
    left->expose(100, 1);
    left->expose(140, 2);
    const StereoFrame frame = cameras->grab(milliseconds(100), milliseconds(100));
    EXPECT_EQ(frame.left.at(0, 0), 2);
    EXPECT_EQ(frame.right.at(0, 0), 12);
    EXPECT_NEAR(seconds(frame.at), 0.1401, 1e-6);
    EXPECT_NEAR(seconds(frame.exposure), 0.0102, 1e-6) << "light must be steady for both";
}

TEST_F(PairedCamerasTest, TheNewestPairIsTakenForFollowing) {
    for (int i = 0; i < 3; ++i) {
        left->expose(40 * i, static_cast<std::uint8_t>(i));
        right->expose(40 * i, static_cast<std::uint8_t>(i));
    }
    left->expose(120, 3);  // its partner is still on its way
    EXPECT_EQ(cameras->newest({}, milliseconds(100)).left.at(0, 0), 2);
    right->expose(120, 3);
    EXPECT_EQ(cameras->newest({}, milliseconds(100)).left.at(0, 0), 3);
}

TEST_F(PairedCamerasTest, AFrameWithoutAPartnerIsLeftOutAndCounted) {
    left->expose(10, 1);
    left->expose(90, 3);
    right->expose(50, 2);
    right->expose(90, 3);
    EXPECT_EQ(cameras->grab({}, milliseconds(100)).right.at(0, 0), 3);
    EXPECT_EQ(cameras->counts().left_alone, 1u);
    EXPECT_EQ(cameras->counts().right_alone, 1u);
}

TEST_F(PairedCamerasTest, ExposuresThatAreApartMakeNoPairAndThatIsSaid) {
    for (int i = 0; i < 4; ++i) {
        left->expose(40 * i, 1);
        right->expose(40 * i + 15, 1);
    }
    EXPECT_NE(refusal().find("do not expose together"), std::string::npos) << refusal();
    EXPECT_EQ(cameras->counts().pairs, 0u);
}

TEST_F(PairedCamerasTest, CamerasOfOneTriggerArePairedThoughTheirClocksAreApart) {
    PairSettings settings;
    settings.together = true;
    auto l = std::make_unique<ScriptedCamera>("left camera", bell),
         r = std::make_unique<ScriptedCamera>("right camera", bell);
    left = l.get();
    right = r.get();
    PairedCameras triggered(std::move(l), std::move(r), bell, clock, settings);
    for (int i = 1; i < 4; ++i) left->expose(40 * i, static_cast<std::uint8_t>(i));
    for (int i = 2; i < 4; ++i) right->expose(40 * i + 6, static_cast<std::uint8_t>(i));  // the first was lost
    for (int i = 2; i < 4; ++i) {
        const StereoFrame frame = triggered.grab({}, milliseconds(100));
        EXPECT_EQ(frame.left.at(0, 0), i);
        EXPECT_EQ(frame.right.at(0, 0), i) << "6 ms apart, and 34 from the next";
        EXPECT_NEAR(seconds(frame.exposure), 0.010, 1e-9);
    }
    EXPECT_EQ(triggered.counts().left_alone, 1u);
}

TEST_F(PairedCamerasTest, ACameraThatSendsNothingOrFailedIsNamed) {
    left->expose(0, 1);
    EXPECT_NE(refusal().find("right camera: no frame came"), std::string::npos);
    left->frames().fail({"nothing came from it for 500 ms", "Look."});
    EXPECT_EQ(refusal(), "left camera: nothing came from it for 500 ms");
    left->frames().recovered();
    left->expose(40, 7);
    right->expose(40, 8);
    EXPECT_EQ(cameras->grab({}, milliseconds(100)).left.at(0, 0), 7) << "nothing else is needed to go on";
}

TEST_F(PairedCamerasTest, WhoseFramesLosePacketsIsNamedWhetherAnyComeOrNone) {
    clock.happens_at = clock.looks + 2;  // while a pair is waited for
    clock.happens = [&] {
        for (int i = 0; i < 4; ++i) left->frames().count_incomplete();
        left->expose(0, 1);
        right->expose(40, 1);
    };
    EXPECT_NE(refusal().find("left camera: of its frames 1 came whole"), std::string::npos);
    EXPECT_GT(clock.looks, clock.happens_at);
    EXPECT_EQ(cameras->doubt(), "left camera: 4 of its last 5 frames lost packets");
    for (int i = 0; i < 25; ++i) left->expose(40 * i, 1);
    EXPECT_EQ(cameras->doubt(), "") << "all of the last came whole";
    right->frames().note_clock(0, {}, milliseconds(40));
    EXPECT_EQ(cameras->doubt(), "right camera: its pictures come 40 ms late");
}

TEST_F(PairedCamerasTest, ACameraThatIsFarBehindIsNamedAndNoOtherCause) {
    for (int i = 0; i < 4; ++i) {
        left->expose(40 * i, 1);
        right->expose(40 * i + 500, 1);
    }
    left->frames().count_incomplete();  // one lost packet is not why
    right->frames().note_clock(0, {}, milliseconds(500));
    EXPECT_EQ(refusal(), "right camera: its pictures come 500 ms late");
}

TEST_F(PairedCamerasTest, NoOldPictureIsTakenForALiveOne) {
    for (int i = 0; i < 50; ++i) {
        left->expose(40 * i, static_cast<std::uint8_t>(i));
        right->expose(40 * i, static_cast<std::uint8_t>(i));
    }
    EXPECT_GE(cameras->grab({}, milliseconds(100)).left.at(0, 0), 46) << "a full queue keeps the newest";
    EXPECT_EQ(left->frames().counts().dropped, 46u);
}

/// Both expose every 40 ms for 10 ms, the first from 100 ms on.
struct ExposuresToCome : PairedCamerasTest {
    void expose(int from, int to) {
        for (int i = from; i < to; ++i) {
            left->expose(105 + 40 * i, static_cast<std::uint8_t>(i));
            right->expose(105.2 + 40 * i, static_cast<std::uint8_t>(i));
            cameras->wait_until_exposed({}, {});  // or only the newest four would be looked at
        }
        clock.t = std::max(clock.t, Instant(milliseconds(100 + 40 * to)));  // the next begins
    }
};

TEST_F(ExposuresToCome, AreOverBeforeTheirFrameHasCome) {
    expose(0, 9);  // until 430 ms; the next are at 460 to 470 and at 500 to 510 ms
    ASSERT_TRUE(cameras->wait_until_exposed(milliseconds(465), milliseconds(2000)));
    EXPECT_GE(clock.t, Instant(milliseconds(510)));
    EXPECT_LE(clock.t, Instant(milliseconds(516)));
    expose(9, 11);
    const StereoFrame frame = cameras->grab(milliseconds(465), milliseconds(100));
    EXPECT_EQ(frame.left.at(0, 0), 10) << "that frame, and none was taken by the waiting";
    EXPECT_LE(frame.at + frame.exposure / 2, clock.t);
}

TEST_F(ExposuresToCome, AreKnownThoughFramesWereLost) {
    expose(0, 4);
    expose(6, 9);
    ASSERT_TRUE(cameras->wait_until_exposed(milliseconds(465), milliseconds(2000)));
    EXPECT_GE(clock.t, Instant(milliseconds(510)));
    EXPECT_LE(clock.t, Instant(milliseconds(516)));
}

TEST_F(ExposuresToCome, OfWhichOneBeginsTooEarlyAndItsPartnerDoesNotAreBothNotMeant) {
    expose(0, 9);
    ASSERT_TRUE(cameras->wait_until_exposed(from_seconds(0.4591), milliseconds(2000)));
    EXPECT_GE(clock.t, Instant(milliseconds(510))) << "left begins at 460 ms: with the margin it is too early";
}

TEST_F(ExposuresToCome, AreNotToldWhereNobodyCanKnowThem) {
    const auto told = [&] { return cameras->wait_until_exposed(clock.t, milliseconds(2000)); };
    expose(0, 4);
    EXPECT_FALSE(told()) << "too few frames";
    expose(4, 9);
    EXPECT_TRUE(told());
    EXPECT_FALSE(cameras->wait_until_exposed(clock.t + std::chrono::seconds(3), milliseconds(5000))) << "too far";
    EXPECT_FALSE(cameras->wait_until_exposed(clock.t + milliseconds(100), milliseconds(50))) << "after the patience";
    left->has_global_shutter(false);
    EXPECT_FALSE(told()) << "its last rows are open when the first have closed";
    left->has_global_shutter(true);
    EXPECT_TRUE(told());
    right->frames().fail({"nothing came from it for 500 ms", "Look."});
    EXPECT_FALSE(told());
    right->frames().recovered();
    for (int i = 0; i < 9; ++i) {  // as computers stamp them that are busy
        left->expose(1000 + 40 * i + (i % 3) * 5, 1);
        right->expose(1000 + 40 * i + (i % 3) * 5, 1);
        told();
    }
    clock.t = milliseconds(1340);
    EXPECT_FALSE(told()) << "no even steps";
}

TEST_F(ExposuresToCome, AreNotReckonedOverSecondsInWhichNobodyLooked) {
    expose(0, 9);
    for (int i = 200; i < 204; ++i) left->expose(105 + 40 * i, 1), right->expose(105 + 40 * i, 1);
    clock.t = milliseconds(8300);
    EXPECT_FALSE(cameras->wait_until_exposed(clock.t, milliseconds(2000)));
    left->expose(105 + 40 * 204, 1), right->expose(105 + 40 * 204, 1);
    EXPECT_TRUE(cameras->wait_until_exposed(clock.t, milliseconds(2000)));
}

TEST_F(ExposuresToCome, BeginAnewWithAnotherExposureOrAClockThatWasSet) {
    expose(0, 9);
    left->expose(465, 1, 25);
    right->expose(465, 1, 25);
    clock.t = milliseconds(500);
    EXPECT_FALSE(cameras->wait_until_exposed(clock.t, milliseconds(2000)));
    expose(12, 21);
    EXPECT_TRUE(cameras->wait_until_exposed(clock.t, milliseconds(2000)));
    left->expose(300, 1);
    EXPECT_FALSE(cameras->wait_until_exposed(clock.t, milliseconds(2000)));
}

}  // namespace
}  // namespace planlight
