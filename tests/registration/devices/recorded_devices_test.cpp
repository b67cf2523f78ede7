#include <gtest/gtest.h>

#include "planning_io/types/error.h"
#include "registration/devices/paired_cameras.h"
#include "registration/devices/recorded_camera.h"
#include "registration/devices/recorded_projector.h"
#include "tests/registration/devices/scripted_camera.h"

namespace planlight {
namespace {

using std::chrono::milliseconds;
using test::SetClock;

/// Frames every 40 ms with 10 ms of exposure, each a picture of its own; between the second and the third one was lost.
std::vector<RecordedFrame> four_frames() {
    const Instant begin = std::chrono::hours(7), exposure = milliseconds(10);
    return {{begin, exposure, 0, 0},
            {begin + milliseconds(40), exposure, 1, 0},
            {begin + milliseconds(120), exposure, 2, 1},
            {begin + milliseconds(160), exposure, 3, 0}};
}

std::vector<GrayImage> pictures_of(int count) {
    std::vector<GrayImage> pictures;
    for (int i = 0; i < count; ++i) pictures.emplace_back(2, 2, static_cast<std::uint8_t>(10 + i));
    return pictures;
}

TEST(RecordedPlay, AtItsOwnPaceAFrameComesWhenItsExposureIsOverAndItsTimesAreThoseOfTheRecording) {
    RecordedPlay play(four_frames(), RecordedPace::own, milliseconds(1000));
    EXPECT_TRUE(play.due(0, milliseconds(1009), 4).empty()) << "the shutter is open";
    const auto first = play.due(0, milliseconds(1010), 4);
    ASSERT_EQ(first.size(), 1U);
    EXPECT_EQ(first[0].at, milliseconds(1005)) << "mid-exposure, on the session's clock";
    EXPECT_TRUE(play.due(1, milliseconds(1049), 4).empty());
    const auto rest = play.due(1, milliseconds(1170), 4);
    ASSERT_EQ(rest.size(), 3U);
    EXPECT_EQ(rest[1].at - rest[0].at, milliseconds(80)) << "the gap of the recording";
    EXPECT_EQ(rest[1].lost, 1U);
    EXPECT_EQ(rest[2].picture, 3U);
}

TEST(RecordedPlay, BeginsAgainOneUsualIntervalAfterItsLastFrame) {
    RecordedPlay play(four_frames(), RecordedPace::own, {});
    EXPECT_EQ(play.round(), milliseconds(200)) << "160 ms from first to last, and 40";
    const auto again = play.due(4, milliseconds(210), 4);
    ASSERT_EQ(again.size(), 1U);
    EXPECT_EQ(again[0].number, 5U);
    EXPECT_EQ(again[0].picture, 0U);
    EXPECT_EQ(again[0].at, milliseconds(205));
}

TEST(RecordedPlay, OfWhatWasMissedTheNewestFramesCome) {
    RecordedPlay play(four_frames(), RecordedPace::own, {});
    const auto late = play.due(0, std::chrono::hours(1), 4);
    ASSERT_EQ(late.size(), 4U);
    EXPECT_GT(late[0].at, std::chrono::hours(1) - milliseconds(250)) << "a round and a bit at most";
    EXPECT_EQ(late[3].number, late[0].number + 3);
}

TEST(RecordedPlay, AtTheFastestPaceBothCamerasGetTheSameFrameAtTheSameMomentAndNoneIsLeftOut) {
    RecordedPlay play(four_frames(), RecordedPace::fastest, {});
    const auto left = play.due(0, milliseconds(5), 4), right = play.due(0, milliseconds(7), 4);
    ASSERT_EQ(left.size(), 1U);
    ASSERT_EQ(right.size(), 1U);
    EXPECT_EQ(left[0].at, milliseconds(10)) << "it begins when it is asked for";
    EXPECT_EQ(right[0].at, left[0].at);
    EXPECT_EQ(play.due(1, milliseconds(7), 4)[0].picture, 1U);
    EXPECT_GT(play.due(1, milliseconds(7), 4)[0].at, left[0].at);
}

TEST(RecordedCameras, PlayTheirPicturesInPairsAndCountWhatTheRecordingHadLost) {
    FrameBell bell;
    FrameQueue left(bell), right(bell);
    RecordedPlay play(four_frames(), RecordedPace::own, {});
    EXPECT_EQ(play_into(left, play, pictures_of(4), 0, milliseconds(170)), 4U);
    EXPECT_EQ(play_into(right, play, pictures_of(4), 0, milliseconds(170)), 4U);
    const auto lefts = left.take_all(), rights = right.take_all();
    ASSERT_EQ(lefts.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(lefts[i].at, rights[i].at);
        EXPECT_EQ(lefts[i].picture.at(0, 0), 10 + static_cast<int>(i));
    }
    EXPECT_EQ(left.counts().incomplete, 1U);
}

TEST(RecordedCameras, AtTheFastestPaceTheNextFrameComesWhenTheOneBeforeWasTaken) {
    FrameBell bell;
    FrameQueue left(bell), right(bell);
    RecordedPlay play(four_frames(), RecordedPace::fastest, {});
    std::uint64_t last = 0, last_right = 0;
    for (int i = 0; i < 10; ++i) {
        last = play_into(left, play, pictures_of(4), last, milliseconds(i));
        last_right = play_into(right, play, pictures_of(4), last_right, milliseconds(i));
    }
    EXPECT_EQ(last, 1U) << "nobody took the first";
    EXPECT_EQ(left.take_all().size(), 1U);
    EXPECT_EQ(play_into(left, play, pictures_of(4), last, milliseconds(11)), 2U);
}

/// On a busy machine one camera's thread may get no turn for a while: what it missed is no frame of the other's.
TEST(RecordedCameras, AtTheFastestPaceNeitherRunsAwayFromTheOther) {
    FrameBell bell;
    SetClock clock;
    RecordedPlay play(four_frames(), RecordedPace::fastest, clock.t);
    auto left = std::make_unique<test::ScriptedCamera>("Left camera", bell),
         right = std::make_unique<test::ScriptedCamera>("Right camera", bell);
    FrameQueue &quick = left->frames(), &slow = right->frames();
    PairedCameras cameras(std::move(left), std::move(right), bell, clock);
    std::uint64_t last_quick = 0, last_slow = 0;
    const auto turn = [&](FrameQueue& camera, std::uint64_t& last) {
        clock.t += milliseconds(1);
        last = play_into(camera, play, pictures_of(4), last, clock.t);
    };
    for (int round = 0; round < 3; ++round) {
        for (int i = 0; i < 20; ++i) {
            turn(quick, last_quick);
            EXPECT_THROW(cameras.grab({}, milliseconds(0)), DeviceError) << "there is one picture only";
        }
        turn(slow, last_slow);
        const StereoFrame frame = cameras.grab({}, milliseconds(0));
        EXPECT_EQ(frame.left.at(0, 0), 10 + round) << "none is left out";
        EXPECT_EQ(frame.right.at(0, 0), 10 + round);
    }
}

/// As the camera threads do it, on a clock of the wall's: nothing is asked of how long it takes.
TEST(RecordedCameras, AreAPairOfCamerasToWhoeverGrabs) {
    FrameBell bell;
    SetClock clock;
    clock.t = milliseconds(500);
    auto play = std::make_shared<RecordedPlay>(four_frames(), RecordedPace::fastest, clock.t);
    auto left = std::make_unique<RecordedCamera>(RecordedSettings{"Left camera", "7", "frames"}, pictures_of(4), play,
                                                 bell, clock);
    EXPECT_EQ(left->width(), 2);
    EXPECT_NE(left->notes().at(0).find("recording \"frames\""), std::string::npos);
    auto right = std::make_unique<RecordedCamera>(RecordedSettings{"Right camera", "8", "frames"}, pictures_of(4), play,
                                                  bell, clock);
    PairedCameras cameras(std::move(left), std::move(right), bell, clock);
    for (int i = 0; i < 9; ++i) {
        const StereoFrame frame = cameras.grab(clock.t, milliseconds(1000));
        EXPECT_EQ(frame.left.at(0, 0), 10 + i % 4) << "none is left out";
        EXPECT_EQ(frame.right.at(0, 0), 10 + i % 4);
    }
}

TEST(RecordedProjector, CamerasSeeThePictureThatIsLitAndTheirOwnOtherwise) {
    SetClock clock;
    auto light = std::make_shared<RecordedLight>();
    const auto which = [](const RgbImage& picture) {
        return picture.at(0, 0)[0] == 200 ? std::optional<std::size_t>(3) : std::nullopt;
    };
    RecordedProjector projector(4, 3, which, light, clock);
    RecordedPlay play({{{}, milliseconds(10), 0, 0}}, RecordedPace::own, {}, light);
    clock.t = milliseconds(100);
    EXPECT_EQ(projector.show(RgbImage(4, 3, {200, 200, 200}), milliseconds(190)), clock.t);
    const auto seen = play.due(0, milliseconds(250), 10);
    ASSERT_EQ(seen.size(), 7U) << "one every 40 ms from 0 to 240";
    EXPECT_EQ(seen[2].picture, 0U) << "80 to 90 ms: before the light";
    EXPECT_EQ(seen[3].picture, 3U) << "from 120 ms on";
    EXPECT_EQ(seen[4].picture, 3U) << "from 160 ms on";
    EXPECT_EQ(seen[5].picture, 0U) << "from 200 ms on: the picture has expired";
    clock.t = milliseconds(300);
    projector.show(RgbImage(4, 3, {200, 200, 200}), milliseconds(900));
    clock.t = milliseconds(330);
    projector.go_dark();
    const auto later = play.due(8, milliseconds(370), 10);
    ASSERT_EQ(later.size(), 2U);
    ASSERT_EQ(later.size(), 2U);
    EXPECT_EQ(later[0].picture, 3U) << "320 to 330 ms";
    EXPECT_EQ(later[1].picture, 0U) << "from 360 ms on: dark was asked for";
}

TEST(RecordedProjector, AnotherSizeIsRefusedAndDark) {
    SetClock clock;
    auto light = std::make_shared<RecordedLight>();
    RecordedProjector projector(
        4, 3, [](const RgbImage&) { return std::optional<std::size_t>(1); }, light, clock);
    projector.show(RgbImage(4, 3), milliseconds(100));
    EXPECT_THROW(projector.show(RgbImage(3, 3), milliseconds(100)), DeviceError);
    EXPECT_FALSE(light->at(milliseconds(1)));
}

}  // namespace
}  // namespace planlight
