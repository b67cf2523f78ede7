#include "projection/light_gate.h"

#include <gtest/gtest.h>

#include "projection/error_figure.h"
#include "tests/projection/light_gate_scenes.h"

// Which figure a ruling gives, and in which words.
namespace planlight {
namespace {

using namespace std::chrono_literals;
using test::item;
using test::seen_at;

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

}  // namespace
}  // namespace planlight
