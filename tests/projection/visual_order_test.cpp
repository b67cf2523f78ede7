// Names that are read from the right, within lines that are read from the left. In the comments capitals stand for
// Hebrew letters as someone who reads English meets them.
#include "projection/visual_order.h"

#include <gtest/gtest.h>

namespace planlight {
namespace {

TEST(VisualOrder, HebrewAndArabicStandFromTheRight) {
    EXPECT_EQ(visual_order("Plan B3, 12.5 mm ⌀ Мария 王"), "Plan B3, 12.5 mm ⌀ Мария 王");
    EXPECT_EQ(visual_order("אבג"), "גבא");
    EXPECT_EQ(visual_order("אב גד"), "דג בא");
    EXPECT_EQ(visual_order("Case of אבג, 12.5 mm"), "Case of גבא, 12.5 mm");
    // Meem, hah, meem, dal of a name: first form, two middle forms, last form (Unicode's presentation forms B).
    EXPECT_EQ(visual_order("محمد"), "ﺪﻤﺤﻣ");
    EXPECT_EQ(visual_order("لا"), "ﻻ") << "lam and alef are one sign";
}

// By the direction of its first letter such a sentence was turned round: GD seemed to pass AB.
TEST(VisualOrder, ASentenceThatBeginsWithSuchANameKeepsItsOrder) {
    EXPECT_EQ(visual_order("אב: it passes 1.2 mm from גד (less than 2 mm)"),
              "בא: it passes 1.2 mm from דג (less than 2 mm)");
    EXPECT_EQ(visual_order("אב. By the match it lies within 1.2 mm (95 %). It passes 0.4 mm from גד."),
              "בא. By the match it lies within 1.2 mm (95 %). It passes 0.4 mm from דג.");
    EXPECT_EQ(visual_order("\"אב\" 1.0 mm, \"גד\" 9.0 mm"), "\"בא\" 1.0 mm, \"דג\" 9.0 mm");
    EXPECT_EQ(visual_order("אב, 2 mm deep."), "בא, 2 mm deep.");
}

TEST(VisualOrder, AFigureKeepsItsSignItsUnitAndItsPlace) {
    EXPECT_EQ(visual_order("אב 12.5 mm"), "בא 12.5 mm");
    EXPECT_EQ(visual_order("12.5 mm אב -3-4 °"), "12.5 mm בא -3-4 °");
    EXPECT_EQ(visual_order("אב (12.5)"), "בא (12.5)");
    EXPECT_EQ(visual_order("אב (95 %)"), "בא (95 %)");
    EXPECT_EQ(visual_order("אב 95 % גד"), "בא 95 % דג");
    EXPECT_EQ(visual_order("אב ⌀ 7 mm"), "בא ⌀ 7 mm");
    EXPECT_EQ(visual_order("אב ⌀7 mm, −5 °"), "בא ⌀7 mm, −5 °");
    EXPECT_EQ(visual_order("محمد ١٢ mm"), "ﺪﻤﺤﻣ ١٢ mm");
}

// Read from the right: alef, bet, hyphen, twelve. As a figure of its own it would read minus twelve.
TEST(VisualOrder, WhatIsJoinedToANameBelongsToIt) {
    EXPECT_EQ(visual_order("אב-12"), "12-בא");
    EXPECT_EQ(visual_order("אב12"), "12בא");
    EXPECT_EQ(visual_order("אב-5 mm"), "5-בא mm");
}

TEST(VisualOrder, NoSignOrdersAnotherDirection) {
    EXPECT_EQ(visual_order("B\u202E12 אב"), "B12 בא");
    EXPECT_EQ(visual_order("B\u202E12"), "B12");
    EXPECT_EQ(visual_order("\u200F5 mm \u200F9 mm"), "5 mm 9 mm");
    EXPECT_EQ(visual_order("\u200FLeft \u200FRight"), "Left Right");
    EXPECT_EQ(visual_order("\u061CT1 \u061CT2"), "T1 T2");
    EXPECT_EQ(visual_order("\u2067T1\u2069 T2"), "T1 T2");
}

// A window would show a joiner as a question mark. Between two Persian letters it keeps them apart: noon and meem in
// their forms at the end and at the beginning.
TEST(VisualOrder, SignsWithoutInkShapeTheirNeighboursAndAreLeftOut) {
    EXPECT_EQ(visual_order("ن\u200Cم"), "ﻡﻥ");
    EXPECT_EQ(visual_order("نم"), "ﻢﻧ");
    EXPECT_EQ(visual_order("♥\uFE0F 3"), "♥ 3");
}

TEST(VisualOrder, ALevelForEachSign) {
    EXPECT_EQ(reading_levels(U"B אב 12"), (std::vector<std::int8_t>{0, 0, 1, 1, 0, 0, 0}));
    EXPECT_TRUE(reading_levels(U"").empty());
}

}  // namespace
}  // namespace planlight
