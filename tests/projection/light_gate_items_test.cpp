// What the gate makes of each item of the plan.
#include <gtest/gtest.h>

#include "projection/light_gate.h"
#include "tests/projection/light_gate_scenes.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;
using test::after;
using test::item;
using test::seen_at;

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
    EXPECT_EQ(after(gate, now, 40, check).trust, LightTrust::aligned) << "what is not lit need not be measured";
}

// Two thirds of a line under a drape, or on a flap that was folded back: what is seen of it lies right.
TEST(LightGate, AnItemThatIsNotFoundForTheMostPartIsNotGreen) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    LightCheck check = seen_at(0.1, 55, 68);
    check.items = {item("Holes", 48, 48, 0.1), item("Cut", 7, 20, 0.1)};
    const auto part = after(gate, now, 40, check);
    EXPECT_EQ(part.headline, "LOOK: \"Cut\" is measured in part only.");
    EXPECT_EQ(part.details.front(), "About 70 % of its light are not found in their place: look there yourself.");
    EXPECT_FALSE(part.found_wrong);
    check.items[1].seen = 16;
    EXPECT_EQ(after(gate, now, 40, check).trust, LightTrust::aligned);
}

// At a limit the banner must not go back and forth: what fell short must be clearly enough before it is enough again.
TEST(LightGate, AnItemAtItsLimitDoesNotFlicker) {
    const auto greens = [](const std::vector<int>& seen_of_100) {
        LightGate gate;
        Instant now{};
        gate.verify(now);
        LightCheck check = seen_at(0.1, 55, 68);
        check.items = {item("Holes", 48, 48, 0.1), item("T1", 0, 100, 0.1)};
        check.items[1].extent_mm = 20;
        std::vector<bool> result;
        for (const int seen : seen_of_100) {
            check.items[1].seen = seen;
            result.push_back(after(gate, now, 40, check).trust == LightTrust::aligned);
        }
        return result;
    };
    EXPECT_EQ(greens({31, 29, 31, 29}), (std::vector{false, false, false, false})) << "never clearly enough";
    EXPECT_EQ(greens({35, 31, 29, 31, 28}), (std::vector{true, true, true, true, true}));
    EXPECT_EQ(greens({35, 26, 29, 31, 34}), (std::vector{true, false, false, false, true}));
}

// Of a hole or a way in the cameras see some of its ring and marks: what they see lies within 30 mm of the rest.
TEST(LightGate, OfASmallItemSomeIsEnoughWhereItTellsBothDirections) {
    LightCheck check = seen_at(0.1, 55, 68);
    for (const double extent_mm : {20.0, 60.0})
        for (const bool one_direction : {false, true})
            for (const int seen : {4, 2}) {
                LightGate gate;
                Instant now{};
                gate.verify(now);
                check.items = {item("Holes", 48, 48, 0.1), item("T1", seen, 10, 0.1)};
                check.items[1].extent_mm = extent_mm;
                check.items[1].one_direction_only = one_direction;
                const auto ruling = after(gate, now, 40, check);
                const bool enough = extent_mm == 20 && !one_direction && seen == 4;
                EXPECT_EQ(ruling.trust == LightTrust::aligned, enough) << ruling.headline;
            }
}

// A head that turns away and back: what was measured before was another moment's light.
TEST(LightGate, AnItemThatComesBackIntoTheLightIsMeasuredAnew) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    LightCheck both = seen_at(0.1);
    both.items = {item("Hole 1", 8, 8, 0.1), item("Hole 2", 6, 6, 0.1)};
    EXPECT_EQ(after(gate, now, 10, both).trust, LightTrust::aligned);
    LightCheck one = both;
    one.items[1] = item("Hole 2", 0, 0, 0, false);
    EXPECT_EQ(after(gate, now, 50, one).trust, LightTrust::aligned);
    EXPECT_EQ(after(gate, now, 2, both).trust, LightTrust::look);
    EXPECT_EQ(after(gate, now, 1, both).trust, LightTrust::aligned);
}

// Dim light need not be seen; where it is, and lies aside, that is no green.
TEST(LightGate, ADimItemIsHeldAgainstTheLightOnlyWhereItIsSeenAside) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    LightCheck check = seen_at(0.1);
    check.items = {item("Hole 1", 8, 8, 0.1), item("Hole 2", 0, 6, 0)};
    check.items[1].dim = true;
    check.items[1].lit_segments = 12;
    const auto alone = after(gate, now, 10, check);
    EXPECT_EQ(alone.trust, LightTrust::aligned);
    EXPECT_EQ(alone.headline, "\"Hole 1\" is on the skin.");
    for (const int seen : {2, 5}) {
        check.items[1].seen = seen;
        check.items[1].off_mm = 1.6;
        const auto ruling = after(gate, now, 10, check);
        EXPECT_EQ(ruling.trust == LightTrust::aligned, seen == 2) << "a third of it may be other light";
        if (seen == 5) {
            EXPECT_EQ(ruling.headline, "LOOK: \"Hole 2\" lies 1.6 mm beside its place.");
        }
    }
}

/// A verified gate with one good item and another, whose looks, 100 ms apart, come round; how many of 100 are green.
int green_of(const std::vector<ItemLight>& looks) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    int green = 0;
    for (std::size_t i = 0; i < 100; ++i) {
        LightCheck check = seen_at(0.1);
        check.items = {item("Hole 1", 8, 8, 0.1), looks[i % looks.size()]};
        green += gate.step(now += 100ms, true, check).trust == LightTrust::aligned;
    }
    return green;
}

/// Under a moving hand, or a shadow that comes and goes, an item is not green for the looks between.
TEST(LightGate, AnItemThatIsGoodNowAndThenIsNotGreen) {
    const ItemLight good = item("Hole 2", 6, 6, 0.2), aside = item("Hole 2", 6, 6, 1.8);
    const ItemLight unseen = item("Hole 2", 0, 6, 0), glimpse = item("Hole 2", 2, 6, 0.2);
    const ItemLight far_in_part = item("Hole 2", 1, 6, 2.9);
    EXPECT_GT(green_of({good}), 95);
    EXPECT_EQ(green_of({good, aside}), 0);
    EXPECT_LE(green_of({glimpse, unseen, unseen, unseen, unseen, unseen, unseen, unseen, unseen, unseen}), 2);
    EXPECT_EQ(green_of({far_in_part, far_in_part, far_in_part, glimpse, far_in_part, far_in_part, far_in_part}), 0);
    EXPECT_GT(green_of({good, good, good, good, unseen, good, good, good, good, good}), 90) << "a hand went by once";
    // With many strokes they take turns: at each look some items are not asked.
    EXPECT_GT(green_of({good, item("Hole 2", 0, 0, 0), item("Hole 2", 0, 0, 0)}), 85);
}

TEST(LightGate, AnItemOfWhichTheCamerasSeeLittleIsMeasuredInPartOnly) {
    LightGate gate;
    Instant now{};
    gate.verify(now);
    LightCheck check = seen_at(0.1);
    check.lit = 60;
    check.items = {item("Hole 1", 8, 8, 0.1), item("Cut", 5, 5, 0.1)};
    check.items[1].lit_segments = 20;
    const auto part = after(gate, now, 40, check);
    EXPECT_EQ(part.headline, "LOOK: \"Cut\" is measured in part only.");
    EXPECT_EQ(part.details.front(), "The cameras can see about 30 % of its light: look at the rest yourself.");
    EXPECT_FALSE(part.found_wrong);
    check.items[1].lit_segments = 8;
    const auto most = after(gate, now, 40, check);
    EXPECT_EQ(most.trust, LightTrust::aligned);
    EXPECT_EQ(most.details.back(), "They see about 70 % of the light.");
}

// Whoever reads it is to know whether to turn the head, to look for a hand, or neither.
TEST(LightGate, AnItemThatIsNotMeasuredSaysWhyAsFarAsItIsKnown) {
    const auto why = [](int lit, int steep, int asked) {
        LightGate gate;
        Instant now{};
        gate.verify(now);
        LightCheck check = seen_at(0.1);
        check.items = {item("Hole 1", 8, 8, 0.1), item("Hole 2", 0, asked, 0)};
        check.items[1].lit_segments = lit, check.items[1].steep_segments = steep;
        const auto ruling = after(gate, now, 10, check);
        EXPECT_EQ(ruling.headline, "LOOK: \"Hole 2\" is not measured.");
        return ruling.details.empty() ? "" : ruling.details.front();
    };
    EXPECT_NE(why(7, 5, 2).find("too flat to be measured"), std::string::npos);
    EXPECT_NE(why(7, 0, 7).find("too faint, or ink"), std::string::npos);
    for (const auto& neither : {why(7, 0, 0), why(8, 3, 2), why(0, 0, 0)})
        EXPECT_NE(neither.find("not apart from other light"), std::string::npos) << neither;
}

}  // namespace
}  // namespace planlight
