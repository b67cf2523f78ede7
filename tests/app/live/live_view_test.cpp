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
