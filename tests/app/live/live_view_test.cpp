#include "app/live/live_view.h"

#include <gtest/gtest.h>

#include <chrono>

namespace planlight {
namespace {

using namespace std::chrono_literals;

struct HandClock final : Clock {
    Instant time = 100s;
    Instant now() const override { return time; }
};

StereoFrame frame_at(Instant at, std::uint8_t grey) {
    StereoFrame frame;
    frame.left = GrayImage(8, 6, grey);
    frame.right = GrayImage(8, 6, static_cast<std::uint8_t>(grey + 1));
    frame.at = at;
    return frame;
}

class LiveViewTest : public testing::Test {
protected:
    OperatorModel shown() const {
        OperatorModel model;
        view.put_into(model);
        return model;
    }
    HandClock clock;
    LiveView view{clock};
};

TEST_F(LiveViewTest, ShowsTheNewestPicturesAndThatNobodyLookedForMarkersInThem) {
    EXPECT_EQ(shown().left.live.picture, nullptr);
    view.take(frame_at(1s, 10));
    EXPECT_EQ(shown().left.live.picture->at(0, 0), 10);
    EXPECT_EQ(shown().right.live.picture->at(0, 0), 11);
    EXPECT_FALSE(shown().left.live.searched) << "no markers found and no markers looked for are not the same";
    EXPECT_EQ(shown().left.old_s, 0);
}

TEST_F(LiveViewTest, WhatWasFoundInAnotherFrameIsNotDrawnOverThisOne) {
    view.take(frame_at(1s, 10));
    view.found(2s, {{{3, 3}, 2}}, {});
    EXPECT_TRUE(shown().left.live.found.empty());
    view.found(1s, {{{3, 3}, 2}}, {});
    ASSERT_EQ(shown().left.live.found.size(), 1U);
    EXPECT_TRUE(shown().right.live.searched);
    clock.time += 1s;
    view.take(frame_at(2s, 20));
    EXPECT_TRUE(shown().left.live.found.empty()) << "they were found in the frame before";
}

TEST_F(LiveViewTest, APictureWaitsForItsMarkersWhereTheyAreLookedFor) {
    view.expect_found(true);
    view.take(frame_at(1s, 10));
    EXPECT_EQ(shown().left.live.picture, nullptr) << "else the rings would flicker";
    view.found(1s, {{{3, 3}, 2}}, {});
    clock.time += 1s;
    view.take(frame_at(2s, 20));
    EXPECT_EQ(shown().left.live.picture->at(0, 0), 10);
    EXPECT_EQ(shown().left.live.found.size(), 1U);
    view.found(2s, {}, {});
    EXPECT_EQ(shown().left.live.picture->at(0, 0), 20);
    EXPECT_TRUE(shown().left.live.found.empty());
    EXPECT_TRUE(shown().left.live.searched);
}

TEST_F(LiveViewTest, APictureInWhichNothingHasMovedIsLiveWithoutBeingDrawnAnew) {
    view.expect_found(true);
    const auto seen = [&](Instant at, const GrayImage& picture, double marker_x) {
        clock.time += 1s;
        StereoFrame frame = frame_at(at, 0);
        frame.left = frame.right = picture;
        view.take(frame);
        view.found(at, {{{marker_x, 100}, 6}}, {});
        return shown().left.live.picture;
    };
    GrayImage room(640, 480, 80), noisy = room, finger = room;
    for (int y = 0; y < 480; ++y)
        for (int x = 0; x < 640; ++x) noisy.at(x, y) = static_cast<std::uint8_t>(74 + (x * 31 + y * 17) % 13);
    for (int y = 200; y < 230; ++y)
        for (int x = 300; x < 312; ++x) finger.at(x, y) = 180;
    const auto first = seen(1s, room, 50);
    EXPECT_EQ(seen(2s, noisy, 50.4), first) << "noise of 12 grey values";
    EXPECT_EQ(shown().left.old_s, 0) << "and it is as live as that";
    const auto moved = seen(3s, noisy, 53);
    EXPECT_NE(moved, first) << "a marker has moved by 3 pixels";
    EXPECT_NE(seen(4s, finger, 53), moved) << "12 x 30 pixels have changed";
    clock.time += 3s;
    EXPECT_EQ(shown().left.old_s, 3);
}

TEST_F(LiveViewTest, APictureThatIsNotRenewedSaysItsAgeAndWhy) {
    view.take(frame_at(1s, 10));
    clock.time += 1400ms;
    EXPECT_EQ(shown().left.old_s, 0);
    clock.time += 200ms;
    EXPECT_EQ(shown().left.old_s, 1) << "1.6 s old";
    clock.time += 5s;
    view.failed("Right camera: no frame came. Look at its cable.");
    EXPECT_EQ(shown().left.old_s, 6);
    EXPECT_EQ(shown().left.note, "") << "it is not the left one that failed";
    EXPECT_EQ(shown().right.note, "Right camera: no frame came. Look at its cable.");
    view.take(frame_at(2s, 20));
    EXPECT_EQ(shown().right.old_s, 0);
    EXPECT_EQ(shown().right.note, "");
}

TEST_F(LiveViewTest, AFaultThatNamesNoCameraIsSaidOfBoth) {
    view.take(frame_at(1s, 10));
    view.failed("the cameras do not expose together");
    EXPECT_EQ(shown().left.note, shown().right.note);
    EXPECT_NE(shown().left.note, "");
}

TEST_F(LiveViewTest, MoreThanAWindowShowsIsNotCopied) {
    view.take(frame_at(1s, 10));
    const auto first = shown().left.live.picture;
    clock.time += 10ms;
    view.take(frame_at(2s, 20));
    EXPECT_EQ(shown().left.live.picture, first);
    clock.time += 50ms;
    view.take(frame_at(3s, 30));
    EXPECT_NE(shown().left.live.picture, first);
}

}  // namespace
}  // namespace planlight
