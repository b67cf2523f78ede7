#include "projection/light_gate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/projection/light_gate_scenes.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;
using test::after;
using test::item;
using test::seen_at;

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

// It takes two running to go dark; until then it is no good look, and not green.
TEST(LightGate, LightThatIsFoundFarAsideNowAndThenIsNotGreen) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    EXPECT_EQ(after(gate, now, 40, seen_at(0.1, 38, 40)).trust, LightTrust::aligned);
    for (int i = 0; i < 10; ++i) {
        const auto far = after(gate, now, 1, found_far(7, 0.1, 28));
        EXPECT_EQ(far.trust, LightTrust::look) << i;
        EXPECT_NE(far.headline.find("7.0 mm beside"), std::string::npos) << far.headline;
        EXPECT_EQ(after(gate, now, 1, seen_at(0.1, 28, 40)).trust, LightTrust::look) << i;
    }
}

// Two ridges found by chance where the lens is covered are no figure of error.
TEST(LightGate, OfTooFewStretchesThereIsNoFigure) {
    LightGate gate;
    Instant now{};
    EXPECT_FALSE(after(gate, now, 1, seen_at(0.1, 2, 40)).off_mm);
    EXPECT_TRUE(after(gate, now, 1, seen_at(0.1, 20, 40)).off_mm);
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

/// Three markers that cannot tell a slip: the light may be right, but nobody could see it go wrong.
TEST(LightGate, WhereASlipOfAMarkerWouldNotShowItIsNotGreen) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    const auto step = [&](double unnoticed_mm) { return gate.step(now += 40ms, true, seen_at(0.1), {}, unnoticed_mm); };
    for (int k = 0; k < 5; ++k) step(2.9);
    EXPECT_EQ(step(2.9).trust, LightTrust::aligned);
    EXPECT_EQ(step(5.2).trust, LightTrust::aligned) << "once: a hand that passes";
    const auto ruling = step(5.2);
    EXPECT_EQ(ruling.trust, LightTrust::look);
    EXPECT_EQ(ruling.headline, "LOOK: so few markers are seen that a slip would not show.");
    EXPECT_EQ(ruling.details.front(),
              "Were one of them pushed aside by 1 mm, the plan could lie 5 mm off without a sign.");
    EXPECT_FALSE(ruling.found_wrong);
    for (int k = 0; k < 20; ++k) EXPECT_EQ(step(0.5).trust, LightTrust::look) << "for a second, against flicker";
    for (int k = 0; k < 8; ++k) step(0.5);
    EXPECT_EQ(step(0.5).trust, LightTrust::aligned);
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
    gate.other_light();
    EXPECT_EQ(after(gate, now, 1, std::nullopt).trust, LightTrust::look) << "nobody has seen it yet";
    EXPECT_EQ(after(gate, now, 2, seen_at(0.1)).trust, LightTrust::look) << "two measurements are fewer than three";
    EXPECT_EQ(after(gate, now, 1, seen_at(0.1)).trust, LightTrust::aligned);
    gate.other_light();
    EXPECT_TRUE(gate.verified()) << "a person has looked";
    EXPECT_EQ(after(gate, now, 10, std::nullopt).headline, "LOOK: the light is being measured.");
    EXPECT_EQ(after(gate, now, 30, std::nullopt).headline, "LOOK: the light is not measured.");
}

/// Darkness is no time in which the light was not measured.
TEST(LightGate, LightThatWasStoppedAndComesBackIsBeingMeasured) {
    LightGate gate;
    Instant now{};
    after(gate, now, 10, seen_at(0.1));
    now += 20s;  // Stop: nothing is asked of the gate
    gate.restart();
    EXPECT_EQ(after(gate, now, 1, std::nullopt).headline, "LOOK: the light is being measured.");
    gate.new_match();
    now += 20s;
    EXPECT_EQ(after(gate, now, 1, std::nullopt).headline, "LOOK: the light is being measured.");
}

/// Two stretches side by side lie elsewhere than the item as a whole, in two looks of a second.
TEST(LightGate, APartOfAnItemThatLiesAsideIsNoGreenUntilItIsSeenRightForASecond) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    LightCheck right = seen_at(0.1), aside = right;
    right.items = aside.items = {item("Hole 1", 8, 8, 0.1), item("Cut", 20, 20, 0.1)};
    aside.items[1].part_off_mm = 2.4;
    EXPECT_EQ(after(gate, now, 10, right).trust, LightTrust::aligned);
    EXPECT_EQ(after(gate, now, 1, aside).trust, LightTrust::aligned) << "once may be chance";
    const auto ruling = after(gate, now, 1, aside);
    EXPECT_EQ(ruling.trust, LightTrust::look);
    EXPECT_EQ(ruling.headline, "LOOK: a part of \"Cut\" lies 2.4 mm beside its place.");
    EXPECT_TRUE(ruling.found_wrong);
    EXPECT_EQ(after(gate, now, 20, right).trust, LightTrust::look) << "0.8 s later";
    EXPECT_EQ(after(gate, now, 8, right).trust, LightTrust::aligned);
}

/// 95 % of what is seen is not 95 % of the light.
TEST(LightGate, GreenSaysHowMuchOfTheLightIsSeen) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    LightCheck half = seen_at(0.1, 21, 40);
    half.lit = 40;
    half.lit_seen = 21;
    const auto ruling = after(gate, now, 10, half);
    EXPECT_EQ(ruling.trust, LightTrust::aligned);
    EXPECT_EQ(ruling.details.back(), "They see about 50 % of the light.");
}

// The light cannot tell whether all markers slid together: who relies on it is told when that was last looked at.
TEST(LightGate, GreenSaysThatTheSkinWasCheckedLongAgo) {
    LightGate gate;
    Instant now{};
    gate.new_match();
    gate.verify(now);
    const auto long_ago = [&](Instant wait) {
        for (const Instant end = now + wait; now < end;) gate.step(now += 1s, true, seen_at(0.1));
        const auto ruling = after(gate, now, 5, seen_at(0.1));
        EXPECT_EQ(ruling.trust, LightTrust::aligned);
        for (const std::string& detail : ruling.details)
            if (detail.find("Skin not checked") != std::string::npos) return detail;
        return std::string();
    };
    EXPECT_EQ(long_ago(9min), "");
    EXPECT_EQ(long_ago(2min), "Skin not checked for 10 minutes: markers that slid all together would not show.");
    EXPECT_EQ(long_ago(8min), "Skin not checked for 15 minutes: markers that slid all together would not show.");
    gate.skin_checked(0.3);
    EXPECT_EQ(long_ago(9min), "") << "checked";
    EXPECT_NE(long_ago(2min), "");
    gate.new_match();
    gate.verify(now);
    EXPECT_EQ(long_ago(9min), "") << "matched anew";
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
    gate.skin_checked(std::numeric_limits<double>::infinity());
    ASSERT_TRUE(gate.forbids()) << "elsewhere, nobody can say by how much";
    EXPECT_EQ(gate.forbids()->headline, "Dark: the skin does not lie where the markers put it.");
    gate.restart();
    EXPECT_TRUE(gate.forbids()) << "nor this";
    gate.new_match();
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

// Hands and instruments over nearly all of the plan: what few edges are taken for light lie anywhere.
TEST(LightGate, FewStretchesThatSeemToLieAsideAreNoReasonToGoDark) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    LightCheck check = seen_at(2.6, 5, 56);
    const auto covered = after(gate, now, 40, check);
    EXPECT_EQ(covered.trust, LightTrust::look);
    EXPECT_FALSE(covered.stop);
    check.seen = 40;
    EXPECT_TRUE(after(gate, now, 3, check).stop) << "light as a whole";
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

TEST(LightGate, LinesThatLampsOutshineAreWarnedOf) {
    const auto warned = [](double brighter, bool seen) {
        LightGate gate;
        Instant now{};
        gate.verify(now);
        LightCheck check = seen_at(0.1);
        check.brighter = check.fainter = brighter;
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
    check.brighter = check.fainter = 0.02;
    EXPECT_TRUE(says(after(gate, now, 10, check), "less than 10 %"));
    check.brighter = check.fainter = 0.27;
    EXPECT_TRUE(says(after(gate, now, 100, check), "less than 30 %"));
    for (const double brighter : {0.31, 0.29, 0.33, 0.31}) {
        check.brighter = check.fainter = brighter;
        EXPECT_TRUE(says(after(gate, now, 100, check), "lamps")) << brighter;
    }
    check.brighter = check.fainter = 0.4;
    EXPECT_FALSE(says(after(gate, now, 100, check), "lamps"));
    check.brighter = check.fainter = 0.33;
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
    gate.skin_checked(std::nan(""));
    EXPECT_TRUE(gate.forbids()) << "what cannot be told is no agreement";
}

}  // namespace
}  // namespace planlight
