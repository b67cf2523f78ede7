#include "projection/light_gate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "projection/error_figure.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

LightCheck seen_at(double off_mm, int seen = 40, int expected = 40) {
    LightCheck check;
    check.expected = expected;
    check.seen = seen;
    check.off_mm = check.most_mm = off_mm;
    check.sigma_mm = 0.05;
    check.told_whole = true;
    return check;
}

ItemLight item(const std::string& name, int seen, int segments, double off_mm, bool lit = true) {
    ItemLight light;
    light.name = name;
    light.lit = lit;
    light.segments = segments;
    light.seen = seen;
    light.off_mm = off_mm;
    return light;
}

/// Updates 40 ms apart with the same measurement; the last ruling.
LightGate::Ruling after(LightGate& gate, Instant& now, int updates, const std::optional<LightCheck>& check,
                        bool lit = true) {
    LightGate::Ruling ruling;
    for (int i = 0; i < updates; ++i) ruling = gate.step(now += 40ms, lit, check);
    return ruling;
}

/// What a look says of light found as one `far_mm` aside, while `seen` of 40 strokes are mistaken near their place.
LightCheck found_far(double far_mm, double near_mm, int seen) {
    LightCheck far = seen_at(near_mm, seen, 40);
    far.far_mm = far_mm;
    return far;
}

/// Nothing is seen near its place, and all of it farther off: that is wrong light, not light that is covered.
TEST(LightGate, LightThatIsFoundFarAsideGoesOut) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    EXPECT_FALSE(after(gate, now, 1, found_far(6.2, 0, 0)).stop) << "once may be chance";
    const auto ruling = after(gate, now, 1, found_far(6.2, 0, 0));
    EXPECT_TRUE(ruling.stop);
    EXPECT_EQ(ruling.headline, "Dark: the light lay 6.2 mm beside the plan.");
    EXPECT_EQ(ruling.off_mm, 6.2);
    EXPECT_TRUE(after(gate, now, 10, seen_at(0.1)).stop) << "until it is asked for again";
}

/// Strokes that are mistaken near their place do not say how far off it is.
TEST(LightGate, TheErrorOfLightThatIsFoundFarAsideIsHowFar) {
    LightGate gate;
    Instant now{};
    EXPECT_EQ(after(gate, now, 1, found_far(8, 0.35, 8)).off_mm, 8);
    EXPECT_EQ(after(gate, now, 2, found_far(8, 0.35, 8)).off_mm, 8);
}

/// All that the cameras can see they see, and it is too little: that is not light that is not seen.
TEST(LightGate, OfTooFewStretchesItSaysThatTheyAreTooFew) {
    LightGate gate;
    Instant now{};
    EXPECT_EQ(after(gate, now, 3, seen_at(0.1, 2, 2)).headline, "LOOK: too little of the light can be measured.");
    EXPECT_EQ(after(gate, now, 3, seen_at(0.1, 1, 2)).headline, "LOOK: the cameras do not see the light.");
}

TEST(LightGate, IsNeverGreenBeforeAPersonHasLooked) {
    LightGate gate;
    Instant now{};
    const auto ruling = after(gate, now, 100, seen_at(0.1));
    EXPECT_EQ(ruling.trust, LightTrust::look);
    EXPECT_TRUE(ruling.ask_to_verify);
    gate.verify(now);
    EXPECT_EQ(after(gate, now, 1, seen_at(0.1)).trust, LightTrust::aligned);
}

TEST(LightGate, IsNeverGreenWithoutAFreshMeasurement) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    EXPECT_EQ(after(gate, now, 10, std::nullopt).trust, LightTrust::look);
    EXPECT_EQ(after(gate, now, 5, seen_at(0.3)).trust, LightTrust::aligned);
    EXPECT_EQ(after(gate, now, 20, std::nullopt).trust, LightTrust::aligned) << "0.8 s old";
    EXPECT_EQ(after(gate, now, 10, std::nullopt).trust, LightTrust::look) << "1.2 s old";
}

/// A ring on a landmark was measured, not the plan that takes its place.
TEST(LightGate, OtherLightIsGreenWhenItHasBeenMeasuredItself) {
    LightGate gate;
    Instant now{};
    EXPECT_EQ(after(gate, now, 10, seen_at(0.1)).trust, LightTrust::look);
    gate.verify(now);
    gate.other_light(now);
    EXPECT_EQ(after(gate, now, 1, std::nullopt).trust, LightTrust::look) << "nobody has seen it yet";
    EXPECT_EQ(after(gate, now, 2, seen_at(0.1)).trust, LightTrust::look) << "two measurements are fewer than three";
    EXPECT_EQ(after(gate, now, 1, seen_at(0.1)).trust, LightTrust::aligned);
    gate.other_light(now);
    EXPECT_TRUE(gate.verified()) << "a person has looked";
    EXPECT_EQ(after(gate, now, 10, std::nullopt).headline, "LOOK: the light is being measured.");
    EXPECT_EQ(after(gate, now, 30, std::nullopt).headline, "LOOK: the light is not measured.");
}

TEST(LightGate, ForbidsLightBeforeItIsLit) {
    LightGate gate;
    Instant now{};
    EXPECT_FALSE(gate.forbids());
    gate.skin_checked(1.5);
    EXPECT_FALSE(gate.forbids()) << "to be looked at";
    gate.skin_checked(3);
    ASSERT_TRUE(gate.forbids());
    EXPECT_TRUE(gate.forbids()->stop);
    EXPECT_NE(gate.forbids()->headline.find("3.0 mm"), std::string::npos);
    gate.restart();
    EXPECT_TRUE(gate.forbids()) << "Track does not mend it";
    gate.new_match();
    EXPECT_FALSE(gate.forbids());
    after(gate, now, 2, seen_at(3));
    EXPECT_TRUE(gate.forbids());
    gate.restart();
    EXPECT_FALSE(gate.forbids()) << "light is asked for again";
}

TEST(LightGate, LightThatIsNotSeenIsNotGreen) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    EXPECT_EQ(after(gate, now, 5, seen_at(0.1)).trust, LightTrust::aligned);
    const auto covered = after(gate, now, 1, seen_at(0.1, 4, 40));
    EXPECT_EQ(covered.trust, LightTrust::look);
    EXPECT_NE(covered.headline.find("do not see"), std::string::npos);
    EXPECT_FALSE(covered.stop) << "a hand before the projector is no reason to go dark";
}

TEST(LightGate, GoesDarkAtTheSecondMeasurementBeyondTheStopAndStaysSo) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    after(gate, now, 5, seen_at(0.1));
    EXPECT_FALSE(after(gate, now, 1, seen_at(2.5)).stop) << "one may be a glint";
    const auto ruling = after(gate, now, 1, seen_at(2.5));
    EXPECT_TRUE(ruling.stop);
    EXPECT_EQ(ruling.trust, LightTrust::dark);
    EXPECT_TRUE(after(gate, now, 50, seen_at(0.1), false).stop) << "it does not come back by itself";
    gate.restart();
    EXPECT_FALSE(after(gate, now, 1, seen_at(0.1)).stop);
}

TEST(LightGate, AfterAStopAPersonLooksAgain) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    gate.restart();
    EXPECT_EQ(after(gate, now, 5, seen_at(0.1)).trust, LightTrust::aligned) << "DARK, and Track, are no stop";
    EXPECT_TRUE(after(gate, now, 2, seen_at(2.5)).stop);
    gate.restart();
    const auto again = after(gate, now, 5, seen_at(0.1));
    EXPECT_EQ(again.trust, LightTrust::look) << "what was verified then lay wrong afterwards";
    EXPECT_TRUE(again.ask_to_verify);
    gate.verify(now);
    EXPECT_EQ(after(gate, now, 5, seen_at(0.1)).trust, LightTrust::aligned);
}

TEST(LightGate, ANewMatchAndALongPauseAskAgain) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    EXPECT_EQ(after(gate, now, 5, seen_at(0.1)).trust, LightTrust::aligned);
    now += 4min;
    EXPECT_EQ(after(gate, now, 5, seen_at(0.1)).trust, LightTrust::aligned) << "a short pause";
    now += 6min;
    EXPECT_TRUE(after(gate, now, 5, seen_at(0.1)).ask_to_verify);
    gate.verify(now);
    gate.new_match();
    EXPECT_NE(after(gate, now, 5, seen_at(0.1)).trust, LightTrust::aligned);
}

TEST(LightGate, AHandInTheLightIsNoReasonToGoDark) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    LightCheck hand = seen_at(2.6);  // a tenth of the light, on the hand
    hand.most_mm = 0.1;
    const auto ruling = after(gate, now, 20, hand);
    EXPECT_FALSE(ruling.stop);
    EXPECT_EQ(ruling.trust, LightTrust::look);
}

TEST(LightGate, EveryItemThatIsLitMustBeMeasured) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    LightCheck check = seen_at(0.1);
    check.items = {item("Hole 1", 8, 8, 0.1), item("Hole 2", 0, 6, 0), item("Far side", 0, 0, 0, false)};
    const auto covered = after(gate, now, 10, check);
    EXPECT_EQ(covered.trust, LightTrust::look);
    EXPECT_NE(covered.headline.find("Hole 2"), std::string::npos) << covered.headline;
    check.items[1] = item("Hole 2", 5, 6, 1.3);
    const auto aside = after(gate, now, 10, check);
    EXPECT_NE(aside.headline.find("1.3 mm"), std::string::npos) << aside.headline;
    check.items[1] = item("Hole 2", 5, 6, 0.2);
    EXPECT_EQ(after(gate, now, 10, check).trust, LightTrust::aligned) << "what is not lit need not be measured";
}

TEST(LightGate, LinesThatLampsOutshineAreWarnedOf) {
    const auto warned = [](double brighter, bool seen) {
        LightGate gate;
        Instant now{};
        gate.verify(now);
        LightCheck check = seen_at(0.1);
        check.brighter = brighter;
        const auto ruling = after(gate, now, 10, seen ? std::optional(check) : std::nullopt);
        EXPECT_EQ(ruling.trust, seen ? LightTrust::aligned : LightTrust::look);
        return std::any_of(ruling.details.begin(), ruling.details.end(),
                           [](const std::string& detail) { return detail.find("lamps") != std::string::npos; });
    };
    EXPECT_TRUE(warned(0.2, true));
    EXPECT_FALSE(warned(0.5, true));
    EXPECT_FALSE(warned(0, true)) << "not known";
    EXPECT_FALSE(warned(0.2, false)) << "not measured";
}

TEST(LightGate, LampsAreNamedWhereTheyOutshineNearlyAllAndTheWarningDoesNotFlicker) {
    const auto says = [](const LightGate::Ruling& ruling, const char* words) {
        return std::any_of(ruling.details.begin(), ruling.details.end(),
                           [&](const std::string& detail) { return detail.find(words) != std::string::npos; });
    };
    LightGate gate;
    Instant now{};
    gate.verify(now);
    EXPECT_TRUE(says(after(gate, now, 10, seen_at(0.1, 2, 40)), "lamps"));
    LightCheck check = seen_at(0.1);
    check.brighter = 0.02;
    EXPECT_TRUE(says(after(gate, now, 10, check), "less than 10 %"));
    check.brighter = 0.27;
    EXPECT_TRUE(says(after(gate, now, 100, check), "less than 30 %"));
    for (const double brighter : {0.31, 0.29, 0.33, 0.31}) {
        check.brighter = brighter;
        EXPECT_TRUE(says(after(gate, now, 100, check), "lamps")) << brighter;
    }
    check.brighter = 0.4;
    EXPECT_FALSE(says(after(gate, now, 100, check), "lamps"));
    check.brighter = 0.33;
    EXPECT_FALSE(says(after(gate, now, 100, check), "lamps"));
}

TEST(LightGate, OneDirectionIsNoPlace) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    LightCheck line = seen_at(0.1);
    line.told_whole = false;
    EXPECT_EQ(after(gate, now, 100, line).trust, LightTrust::look);
    EXPECT_EQ(after(gate, now, 3, seen_at(0.1)).trust, LightTrust::aligned);
}

TEST(LightGate, AKnownFaultIsNotGreenUnlessItIsDealtWith) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    after(gate, now, 5, seen_at(0.4));
    LightCause bumped{LightFault::projector_moved, 0.5, 0, 0, -1, 0.9, true};
    EXPECT_EQ(gate.step(now += 40ms, true, seen_at(0.4), {bumped}).trust, LightTrust::look);
    LightCause slipped{LightFault::marker_slipped, 1, 0, 0, 2, 1, false};
    const auto ruling = gate.step(now += 40ms, true, seen_at(0.1), {slipped});
    EXPECT_EQ(ruling.trust, LightTrust::aligned) << "the patient is followed without that marker";
    EXPECT_NE(ruling.details[1].find("Marker 3 has slipped by 1.0 mm"), std::string::npos) << ruling.details[1];
}

TEST(LightGate, SkinThatLiesElsewhereStopsTheLightUntilTheNextMatch) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    after(gate, now, 5, seen_at(0.1));
    gate.skin_checked(0.3);
    EXPECT_EQ(after(gate, now, 1, seen_at(0.1)).trust, LightTrust::aligned);
    gate.skin_checked(1.4);
    EXPECT_EQ(after(gate, now, 1, seen_at(0.1)).trust, LightTrust::look);
    gate.skin_checked(2.6);
    EXPECT_TRUE(after(gate, now, 1, seen_at(0.1)).stop);
    gate.restart();
    EXPECT_TRUE(after(gate, now, 1, seen_at(0.1)).stop) << "Track does not mend it";
    gate.new_match();
    EXPECT_FALSE(after(gate, now, 1, seen_at(0.1)).stop);
}

/// What CHECK makes of light that lies aside by `shift_mm` (along the skin), as `measure_light_check` found it to err:
/// 0.1 mm a stretch, one stretch in fifty something else within reach, nothing found beyond 3 mm.
LightCheck drawn_check(const Eigen::Vector2d& shift_mm, double covered, bool one_way, std::mt19937& random) {
    std::normal_distribution<double> noise(0, 0.1);
    std::uniform_real_distribution<double> any(-3, 3), share(0, 1);
    LightCheck check;
    check.expected = std::uniform_int_distribution<int>(12, 60)(random);
    std::vector<double> sizes;
    for (int i = 0; i < check.expected; ++i) {
        const double angle = one_way ? 0.02 * any(random) : 2 * any(random);
        const double off_mm = shift_mm.dot(Eigen::Vector2d(std::cos(angle), std::sin(angle))) + noise(random);
        if (share(random) < covered || std::abs(off_mm) > 3) continue;
        sizes.push_back(std::abs(share(random) < 0.02 ? any(random) : off_mm));
    }
    std::sort(sizes.begin(), sizes.end());
    const auto at = [&](double q) {
        return sizes.empty() ? 0 : sizes[static_cast<std::size_t>(q * static_cast<double>(sizes.size() - 1))];
    };
    check.seen = static_cast<int>(sizes.size());
    check.off_mm = at(0.95);
    check.most_mm = at(2.0 / 3);
    check.told_whole = !one_way && check.seen >= 3;
    return check;
}

// "up to 2.0 mm" in the headline beside "2.1 mm" at its right would be two figures of one thing.
TEST(LightGate, AFigureIsSaidAsTheBannerSaysIt) {
    for (const double off_mm : {1.02, 1.5, 2.02, 2.04, 2.6}) {
        LightGate gate;
        LightCheck check = seen_at(off_mm);
        check.most_mm = 0.9;  // so that the light stays
        const auto ruling = gate.step(1s, true, check);
        const std::string figure = error_figure(*ruling.off_mm, {1, 2});
        EXPECT_NE(ruling.headline.find("up to " + figure + " mm"), std::string::npos) << ruling.headline;
        EXPECT_FALSE(ruling.of_other);
    }
    EXPECT_EQ(error_figure(2.02, {1, 2}), "2.1");
}

TEST(LightGate, WhyItIsDarkIsStillSaidWithItsFigureWhenTheLightIsOut) {
    LightGate gate;
    gate.step(1s, true, seen_at(7.3));
    EXPECT_TRUE(gate.step(2s, true, seen_at(7.3)).stop);
    EXPECT_EQ(gate.step(3s, false, std::nullopt).headline, "Dark: the light lay 7.3 mm beside the plan.");
    ASSERT_TRUE(gate.forbids());
    EXPECT_EQ(gate.forbids()->headline, "Dark: the light lay 7.3 mm beside the plan.");
}

TEST(LightGate, WhatTheSkinOrAnItemIsOffIsNotGivenAsMeasuredOfTheLight) {
    LightGate gate;
    gate.skin_checked(1.6);
    const auto by_skin = gate.step(1s, true, seen_at(0.3));
    EXPECT_NE(by_skin.headline.find("1.6 mm"), std::string::npos) << by_skin.headline;
    EXPECT_TRUE(by_skin.of_other);
    EXPECT_DOUBLE_EQ(by_skin.off_mm.value_or(0), 0.3);
    LightGate other;
    LightCheck check = seen_at(0.3);
    check.items = {item("B1", 10, 10, 1.4)};
    const auto by_item = other.step(1s, true, check);
    EXPECT_NE(by_item.headline.find("1.4 mm"), std::string::npos) << by_item.headline;
    EXPECT_TRUE(by_item.of_other);
    EXPECT_DOUBLE_EQ(by_item.off_mm.value_or(0), 0.3);
}

// 100,000 situations: light that begins to lie aside by up to 6 mm in any direction, wholly or partly covered, drawn by
// strokes that run every way or one way only. Light more than 2 mm off is green in less than one in a thousand after
// half a second; good light that is seen is never put out.
TEST(LightGate, WrongLightIsNotGreenAndGoodLightIsNotDark) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> size_mm(0, 6), angle(0, 6.2832), share(0, 1);
    int wrong = 0, wrong_and_green = 0, good = 0, good_and_dark = 0, good_and_green = 0;
    for (int run = 0; run < 100000; ++run) {
        LightGate gate;
        Instant now{};
        gate.verify(now);
        const bool one_way = share(random) < 0.2;
        for (int i = 0; i < 5; ++i) gate.step(now += 120ms, true, drawn_check({0, 0}, 0, one_way, random));
        const double off_mm = share(random) < 0.3 ? 0.3 * share(random) : size_mm(random);
        const double covered = share(random) < 0.5 ? 0 : share(random), a = angle(random);
        LightGate::Ruling ruling;
        for (int i = 0; i < 5 && !ruling.stop; ++i)
            ruling =
                gate.step(now += 120ms, true,
                          drawn_check(off_mm * Eigen::Vector2d(std::cos(a), std::sin(a)), covered, one_way, random));
        if (off_mm > 2) {
            ++wrong;
            wrong_and_green += ruling.trust == LightTrust::aligned;
        } else if (off_mm <= 0.3) {
            ++good;
            good_and_dark += ruling.stop;
            good_and_green += ruling.trust == LightTrust::aligned;
        }
    }
    RecordProperty("wrong", wrong);
    RecordProperty("good_and_green", good_and_green);
    EXPECT_GT(wrong, 40000);
    EXPECT_GT(good, 20000);
    EXPECT_LT(wrong_and_green, wrong / 1000) << "of " << wrong;
    EXPECT_LT(good_and_dark, good / 200) << "of " << good;
    EXPECT_GT(good_and_green, good / 3) << "of " << good << ", a half covered in part and a fifth one way";
}

}  // namespace
}  // namespace planlight
