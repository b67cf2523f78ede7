#include "projection/light_gate.h"

#include <gtest/gtest.h>

#include <random>

namespace planlight {
namespace {

using namespace std::chrono_literals;

LightCheck seen_at(double off_mm, int seen = 40, int expected = 40) {
    LightCheck check;
    check.expected = expected;
    check.seen = seen;
    check.off_mm = off_mm;
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

// 100,000 random runs of faults of any size: light more than 2 mm off that is measured so is green in none; good light
// is never darkened.
TEST(LightGate, NoMeasuredErrorBeyondTheStopIsEverGreen) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> size_mm(0, 6);
    std::uniform_int_distribution<int> seen(0, 40), length(1, 6);
    int green_and_wrong = 0, dark_and_right = 0;
    for (int run = 0; run < 100000; ++run) {
        LightGate gate;
        Instant now{};
        gate.verify(now);
        after(gate, now, 4, seen_at(0.2));
        const double off_mm = size_mm(random);
        const auto ruling = after(gate, now, length(random), seen_at(off_mm, seen(random)));
        green_and_wrong += ruling.trust == LightTrust::aligned && off_mm > 2;
        dark_and_right += ruling.stop && off_mm <= 1;
    }
    EXPECT_EQ(green_and_wrong, 0);
    EXPECT_EQ(dark_and_right, 0);
}

}  // namespace
}  // namespace planlight
