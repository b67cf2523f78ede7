#include "app/live/skin_check_schedule.h"

#include <gtest/gtest.h>

#include <cmath>

namespace planlight {
namespace {

using namespace std::chrono_literals;

constexpr Instant kFrame = 50ms;

/// Plays updates from `from` on, `known_at` at zero, until a check is to begin, at most to `until`.
struct Played {
    std::optional<Instant> announced, checked;
    std::vector<std::string> notices;
};
template <class MarkersAt>
Played play(SkinCheckSchedule& schedule, Instant from, Instant until, MarkersAt markers_at, bool lit = true) {
    Played played;
    for (Instant at = from; at < until && !played.checked; at += kFrame) {
        const SkinCheckSchedule::Turn turn = schedule.step(at, Instant{}, lit, markers_at(at));
        if (!turn.notice.empty() && !played.announced) played.announced = at;
        if (!turn.notice.empty()) played.notices.push_back(turn.notice);
        if (turn.check) played.checked = at;
    }
    return played;
}

std::vector<Eigen::Vector3d> at_rest(Instant) {
    return {{0, 0, 900}, {60, 0, 905}, {0, 60, 910}};
}

SkinCheckSchedule every(Instant how_often) {
    SkinCheckScheduleSettings settings;
    settings.every = how_often;
    return SkinCheckSchedule(settings);
}

TEST(SkinCheckSchedule, WithoutAWishNothingIsChecked) {
    SkinCheckSchedule schedule;
    const Played played = play(schedule, 0s, 3600s, at_rest);
    EXPECT_FALSE(played.announced);
    EXPECT_FALSE(played.checked);
}

TEST(SkinCheckSchedule, APatientAtRestIsCheckedAsOftenAsWasWishedAfterFiveSecondsNotice) {
    SkinCheckSchedule schedule = every(60s);
    const Played played = play(schedule, 0s, 120s, at_rest);
    ASSERT_TRUE(played.checked);
    EXPECT_EQ(*played.announced, Instant(60s));
    EXPECT_EQ(*played.checked, Instant(65s));
    EXPECT_EQ(played.notices.front(), "The skin is checked in 5 s: keep the patient still.");
}

TEST(SkinCheckSchedule, AMovingPatientIsNotLitWithStripesAndOneWhoRestsIs) {
    SkinCheckSchedule schedule = every(60s);
    // 20 mm to and fro, and from 90 s on at rest.
    const Played played = play(schedule, 0s, 200s, [](Instant at) {
        std::vector<Eigen::Vector3d> markers = at_rest(at);
        if (at < 90s)
            for (auto& marker : markers) marker.x() += 10 * std::sin(2 * seconds(at));
        return markers;
    });
    ASSERT_TRUE(played.checked);
    EXPECT_GE(*played.checked, Instant(92s));
    EXPECT_LE(*played.checked, Instant(92s) + kFrame);
    EXPECT_EQ(played.notices.back(), "The skin is checked as soon as the patient lies still.");
}

// A slow slide of 1 mm a second is a tenth of a millimetre from one look to the next.
TEST(SkinCheckSchedule, ASlowMovementIsNoRest) {
    SkinCheckSchedule schedule = every(60s);
    const Played played = play(schedule, 0s, 300s, [](Instant at) {
        std::vector<Eigen::Vector3d> markers = at_rest(at);
        for (auto& marker : markers) marker.y() += seconds(at);
        return markers;
    });
    EXPECT_TRUE(played.announced);
    EXPECT_FALSE(played.checked);
}

TEST(SkinCheckSchedule, MarkersThatAreNotSeenAreNoRest) {
    SkinCheckSchedule schedule = every(60s);
    const Played played = play(schedule, 0s, 300s, [](Instant at) {
        return at % Instant(1s) == Instant{} ? std::vector<Eigen::Vector3d>{} : at_rest(at);
    });
    EXPECT_FALSE(played.checked);
}

TEST(SkinCheckSchedule, LightThatNobodyVerifiedIsNotInterrupted) {
    SkinCheckSchedule schedule = every(60s);
    EXPECT_FALSE(play(schedule, 0s, 300s, at_rest, false).announced);
    const Played verified = play(schedule, 300s, 400s, at_rest);
    EXPECT_EQ(verified.announced, Instant(300s));
    EXPECT_EQ(verified.checked, Instant(305s)) << "never without notice";
}

TEST(SkinCheckSchedule, ACheckWithoutAnAnswerIsTriedAgainAfterAWhileAndAnnouncedAgain) {
    SkinCheckSchedule schedule = every(60s);
    const Played first = play(schedule, 0s, 120s, at_rest);
    ASSERT_TRUE(first.checked);
    schedule.began(*first.checked);
    const Played second = play(schedule, *first.checked + 1s, 200s, at_rest);  // `known_at` is as it was
    EXPECT_EQ(second.announced, *first.checked + Instant(20s));
    EXPECT_EQ(second.checked, *first.checked + Instant(25s));
}

TEST(SkinCheckSchedule, LightThatWasAwayIsNotInterruptedByWhatWasAnnouncedBefore) {
    SkinCheckSchedule schedule = every(60s);
    EXPECT_FALSE(play(schedule, 60s, 63s, at_rest).checked);
    schedule.restart();
    const Played after = play(schedule, 100s, 120s, at_rest);
    EXPECT_EQ(after.announced, Instant(100s));
    EXPECT_EQ(after.checked, Instant(105s));
}

}  // namespace
}  // namespace planlight
