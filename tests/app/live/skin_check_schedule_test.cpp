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

TEST(SkinCheckSchedule, ChecksWithoutAnAnswerComeLessAndLessOften) {
    SkinCheckSchedule schedule = every(60s);
    std::vector<double> began_s;
    Instant from{};
    for (int i = 0; i < 5; ++i) {  // `known_at` stays as it was
        const Played played = play(schedule, from, from + Instant(200s), at_rest);
        ASSERT_TRUE(played.checked);
        EXPECT_GE(*played.checked - *played.announced, Instant(5s)) << "each is announced";
        schedule.began(*played.checked);
        began_s.push_back(seconds(*played.checked));
        from = *played.checked + Instant(1s);
    }
    EXPECT_EQ(began_s, (std::vector<double>{65, 65 + 25, 90 + 45, 135 + 65, 200 + 65}))
        << "20, 40, 60 s and 5 s notice";
}

TEST(SkinCheckSchedule, AfterAnAnswerItBeginsAnew) {
    SkinCheckSchedule schedule = every(60s);
    for (const Instant at : {65s, 90s}) schedule.began(at);
    std::optional<Instant> checked;
    for (Instant at = 100s; at < 300s && !checked; at += kFrame)
        if (schedule.step(at, 100s, true, at_rest(at)).check) checked = at;
    EXPECT_EQ(checked, Instant(165s));
}

TEST(SkinCheckSchedule, WhoNeverRestsIsNotAskedToWithoutEnd) {
    SkinCheckSchedule schedule = every(300s);
    const Played played = play(schedule, 300s, 420s, [](Instant at) {
        std::vector<Eigen::Vector3d> markers = at_rest(at);
        for (auto& marker : markers) marker.z() += std::sin(1.5 * seconds(at));  // breath
        return markers;
    });
    EXPECT_FALSE(played.checked);
    const auto asked_s = static_cast<double>(played.notices.size()) * seconds(kFrame);
    EXPECT_NEAR(asked_s, 5 + 60 + 35, 0.5) << "again 20 s later, until the end";
}

TEST(SkinCheckSchedule, LightThatWasAwayIsNotInterruptedByWhatWasAnnouncedBefore) {
    for (const bool told : {true, false}) {  // by Track, or by a gap, as a lost camera leaves one
        SkinCheckSchedule schedule = every(60s);
        EXPECT_FALSE(play(schedule, 60s, 63s, at_rest).checked);
        if (told) schedule.restart();
        const Played after = play(schedule, 100s, 120s, at_rest);
        EXPECT_EQ(after.announced, Instant(100s));
        EXPECT_EQ(after.checked, Instant(105s));
    }
}

}  // namespace
}  // namespace planlight
