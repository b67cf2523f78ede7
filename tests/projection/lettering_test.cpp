#include "projection/lettering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "projection/label_codes.h"
#include "projection/label_names.h"
#include "projection/lay_out_label.h"

namespace planlight {
namespace {

double ink(const TextOutline& text) {
    double area = 0;
    for (const Sign& sign : text.signs) {
        double twice = 0;
        for (const auto& o : sign.outlines)
            for (std::size_t i = 0; i < o.size(); ++i) {
                const auto &a = o[i], &b = o[(i + 1) % o.size()];
                twice += a.x() * b.y() - a.y() * b.x();
            }
        area += std::abs(twice) / 2;
    }
    return area;
}

TEST(Lettering, CapitalsAreOneHighAndStandOnTheBaseline) {
    for (const char* letter : {"H", "E", "I", "T"}) {
        const TextOutline text = lettering().outline(letter);
        EXPECT_NEAR(text.high, 1, 0.01) << letter;
        EXPECT_NEAR(text.low, 0, 0.01) << letter;
    }
}

/// From left to right, and how high: of one sign.
struct Extent {
    double left = 1e9, right = -1e9, low = 1e9, high = -1e9;
};
Extent extent(const Sign& sign) {
    Extent e;
    for (const auto& outline : sign.outlines)
        for (const auto& p : outline) {
            e.left = std::min(e.left, p.x()), e.right = std::max(e.right, p.x());
            e.low = std::min(e.low, p.y()), e.high = std::max(e.high, p.y());
        }
    return e;
}

// 7.5 must not be read as 75.
TEST(Lettering, APointWithinANumberIsLargerAndTouchesNoDigit) {
    const auto point = [](const char* text) { return lettering().outline(text).signs.at(1); };
    for (const char* number : {"7.5", "1.4", "4.1"}) {
        const TextOutline text = lettering().outline(number);
        const Extent before = extent(text.signs.at(0)), at = extent(text.signs.at(1)), after = extent(text.signs.at(2));
        const Extent usual = extent(point("n.n"));
        EXPECT_NEAR((at.high - at.low) / (usual.high - usual.low), 1.6, 0.01) << number;
        EXPECT_GT(at.left - before.right, 0.08) << number;
        EXPECT_GT(after.left - at.right, 0.08) << number;
    }
    EXPECT_NEAR(extent(point("7,5")).right - extent(point("7,5")).left,
                1.6 * (extent(point("n,n")).right - extent(point("n,n")).left), 0.01);
    const double end_of_name = extent(point("7.")).high, usual = extent(point("n.n")).high;
    EXPECT_NEAR(end_of_name, usual, 1e-9) << "a point that ends a name changes no number";
}

TEST(Lettering, LettersOfManyLanguagesHaveOutlines) {
    for (const char* name : {"Schädelöffnung", "Groß", "Разрез", "Τομή", "额部截骨线", "頭蓋骨", "절골술", "شق", "Łódź",
                             "Đường cắt", "İğne", "חתך"}) {
        const TextOutline text = lettering().outline(name);
        EXPECT_TRUE(text.lacks.empty()) << name;
        EXPECT_GE(text.signs.size(), 2u) << name;
        EXPECT_GT(text.width, 1) << name;
        EXPECT_GT(ink(text), 0.15) << name;
    }
}

TEST(Lettering, AnAccentOfItsOwnIsDrawnAsTheLetterWithTheAccent) {
    const TextOutline one = lettering().outline("Mü\u00e9"), apart = lettering().outline("Mu\u0308e\u0301");
    EXPECT_TRUE(apart.lacks.empty());
    EXPECT_NEAR(apart.width, one.width, 0.02);
    EXPECT_NEAR(apart.high, one.high, 0.05);
    EXPECT_NEAR(ink(apart), ink(one), 0.03 * ink(one));
}

TEST(Lettering, ArabicIsJoinedAndRunsFromTheRight) {
    const TextOutline alone = lettering().outline("ب"), joined = lettering().outline("بب");
    EXPECT_LT(joined.width, 1.8 * alone.width)
        << "letters at the beginning of a word are short, and joined to the next";
    // Alef, beh: the beh, with its dot under the line, is the last and stands at the left.
    const TextOutline word = lettering().outline("اب");
    ASSERT_GE(word.signs.size(), 2u);
    const auto low_of = [](const Sign& sign) {
        double low = 1e9;
        for (const auto& outline : sign.outlines)
            for (const auto& p : outline) low = std::min(low, p.y());
        return low;
    };
    EXPECT_LT(low_of(word.signs.front()), -0.2);
    EXPECT_GT(low_of(word.signs.back()), -0.2);
    // Figures in it run from the left.
    const TextOutline figures = lettering().outline("شق 12"), twelve = lettering().outline("12");
    EXPECT_TRUE(figures.lacks.empty());
    EXPECT_GT(figures.width, twelve.width + 0.5);
}

// "12 mm" after a Hebrew name was lit as "mm 12", and "12.5 אב, mm" where the line begins in English.
TEST(Lettering, AFigureKeepsItsUnitAndItsPlaceBesideANameFromTheRight) {
    const TextOutline figure = lettering().outline("12 mm"), behind = lettering().outline("אב 12 mm");
    ASSERT_EQ(figure.signs.size(), 4u);
    ASSERT_EQ(behind.signs.size(), 6u);
    const double before = behind.signs[2].outlines[0][0].x() - figure.signs[0].outlines[0][0].x();
    EXPECT_GT(before, 0.5) << "at the right of the name, as in the window";
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(behind.signs[2 + i].outlines[0][0].x() - figure.signs[i].outlines[0][0].x(), before, 1e-9);
    // A hyphen within a name is no minus of the figure after it: read from the right, alef, bet, hyphen, one, two.
    const TextOutline joined = lettering().outline("אב-12"), twelve = lettering().outline("12");
    ASSERT_EQ(joined.signs.size(), 5u);
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(joined.signs[i].outlines[0].size(), twelve.signs[i].outlines[0].size()) << "12 stands at the left";
    const TextOutline after = lettering().outline("B אב, 12 mm");
    ASSERT_EQ(after.signs.size(), 8u);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(after.signs[4 + i].outlines.size(), figure.signs[i].outlines.size()) << "12 mm stands at the end";
    EXPECT_NEAR(after.signs[7].outlines[0][0].x() - after.signs[4].outlines[0][0].x(),
                figure.signs[3].outlines[0][0].x() - figure.signs[0].outlines[0][0].x(), 1e-9);
}

TEST(Lettering, WhatNoFontHasIsToldAndNothingIsDrawn) {
    for (const char* name : {"B\U0010FFFD", "\uE123 links", "bad \xFF byte"}) {
        const TextOutline text = lettering().outline(name);
        EXPECT_FALSE(text.lacks.empty()) << name;
        EXPECT_TRUE(text.signs.empty()) << name;
    }
}

TEST(Lettering, WithoutAnyFontThePlainLinesHaveWesternEuropeanLettersOnly) {
    for (const Lettering& none : {Lettering({}), Lettering({{"/no/such/font.ttf", 0, "none"}})}) {
        EXPECT_TRUE(none.families().empty());
        EXPECT_TRUE(none.outline("B3 ⌀7 Schädel").lacks.empty());
        EXPECT_GT(none.outline("B3").signs.size(), 1u);
        EXPECT_FALSE(none.outline("Разрез").lacks.empty());
    }
}

TEST(Lettering, ControlSignsAndMarksOfDirectionLeaveNoInk) {
    EXPECT_NEAR(lettering().outline("B\u200e3\n").width, lettering().outline("B3").width, 1e-6);
}

TEST(LayOutLabel, ALongNameIsShortenedInTheMiddleAndTheFigureKept) {
    const std::string name = "Osteotomiefrontoorbitalbeidseitigmitverlaengerungnachtemporal";
    const std::string shorter = shortened(name, 5);
    EXPECT_LT(shorter.size(), 20u);
    const auto cut = shorter.find("…");
    ASSERT_NE(cut, std::string::npos);
    EXPECT_EQ(name.find(shorter.substr(0, cut)), 0u);
    const std::string end = shorter.substr(cut + std::string("…").size());
    EXPECT_EQ(name.substr(name.size() - end.size()), end);
    const TextBlock block = lay_out({name, {"128 mm"}}, 5);
    EXPECT_EQ(block.words, shorter + "\n128 mm");
    EXPECT_LE(block.width_mm, kMaxLine_mm + 1e-6);
}

TEST(LayOutLabel, ANameOfTwoWordsStandsOnTwoLinesWhole) {
    EXPECT_EQ(lay_out({"Resection margin", {"62 mm"}}, 5).words, "Resection\nmargin\n62 mm");
    EXPECT_EQ(lay_out({"额部截骨线左侧内缘", {"62 mm"}}, 5).words, "额部截骨线\n左侧内缘\n62 mm");
}

TEST(LayOutLabel, FiguresStandOnLinesOfTheirOwnSoThatNoTwoAreReadAsOne) {
    EXPECT_EQ(lay_out({"B3", {"7 mm wide", "6 mm deep"}}, 5).words, "B3\n7 mm wide\n6 mm deep");
    EXPECT_EQ(lay_out({"", {"7 mm wide", "6 mm deep"}}, 5).words, "7 mm wide\n6 mm deep");
}

TEST(LayOutLabel, LinesTouchNeitherEachOtherNorTheBlocksEdge) {
    for (const char* name : {"Ägypten gyq", "额部截骨线左侧内缘", "شق طويل"}) {
        const TextBlock block = lay_out({name, {"7 mm wide", "6 mm deep"}}, 5);
        double above = 1e9;  // the ink of the line before ends there
        for (const auto& line : block.lines) {
            const double high = line.begins_mm.y() + 5 * line.text.high, low = line.begins_mm.y() + 5 * line.text.low;
            EXPECT_LE(high, block.height_mm / 2 + 1e-6) << name;
            EXPECT_GE(low, -block.height_mm / 2 - 1e-6) << name;
            EXPECT_LT(high, above - 1) << name;
            above = low;
        }
    }
}

TEST(LitNames, WhatCannotBeDrawnIsLeftOutAndHasItsCode) {
    const auto names = lit_names({"B1", "\U0010FFFD links", "B3"}, 5);
    EXPECT_EQ(names[0].name, "B1");
    EXPECT_TRUE(names[0].warning.empty());
    EXPECT_EQ(names[1].name, "#2");
    EXPECT_NE(names[1].warning.find("U+10FFFD"), std::string::npos) << names[1].warning;
    EXPECT_NE(names[1].warning.find("rename"), std::string::npos) << names[1].warning;
    EXPECT_EQ(names[2].name, "B3");
}

TEST(Lettering, NoSignInANameTurnsItsFiguresRound) {
    // B12 in every window: an override of direction would light it as B21.
    const TextOutline plain = lettering().outline("B12");
    for (const char* name : {"B\u202E12", "B\u202E12\u202C", "\u202EB12", "B\u206712\u2069", "\u202BB12"}) {
        const TextOutline text = lettering().outline(name);
        ASSERT_EQ(text.signs.size(), plain.signs.size()) << name;
        for (std::size_t i = 0; i < plain.signs.size(); ++i)
            EXPECT_EQ(text.signs[i].outlines, plain.signs[i].outlines) << name << " sign " << i;
    }
}

TEST(Lettering, AFontOfTheSitesThatIsNoneIsToldOf) {
    EXPECT_TRUE(fault_of_own_font().empty());
    ASSERT_EQ(setenv("PLANLIGHT_FONT", "/no/such/font.ttf", 1), 0);
    EXPECT_NE(fault_of_own_font(Lettering(font_files())).find("/no/such/font.ttf"), std::string::npos);
    const auto all = [] {
        unsetenv("PLANLIGHT_FONT");
        return font_files();
    }();
    if (!all.empty() && all.front().index == 0) {
        ASSERT_EQ(setenv("PLANLIGHT_FONT", all.front().file.c_str(), 1), 0);
        EXPECT_EQ(fault_of_own_font(Lettering(font_files())), "") << all.front().file;
    }
    unsetenv("PLANLIGHT_FONT");
}

TEST(LitNames, NamesThatShorteningMakesTheSameHaveTheirCodes) {
    const std::string a = "Osteotomiefrontaleinslinksaussen", b = "Osteotomiefrontalzweilinksaussen";
    const auto names = lit_names({a, b, "left", "right"}, 5);
    EXPECT_EQ(names[0].name, "#1");
    EXPECT_EQ(names[1].name, "#2");
    EXPECT_TRUE(names[1].by_code);
    EXPECT_FALSE(names[1].warning.empty());
    EXPECT_EQ(names[2].name, "left");
    EXPECT_EQ(names[2].code, "#3");
}

TEST(LitNames, NothingIsLitTwiceTheSame) {
    for (const char* same : {"B7", "B7 ", "B\u200E7"}) {
        const auto names = lit_names({"B7", "C", same}, 5);
        EXPECT_EQ(names[0].name, "#1") << same;
        EXPECT_EQ(names[2].name, "#3") << same;
        EXPECT_NE(names[2].warning.find("name"), std::string::npos);
    }
}

// "В2" with the Cyrillic letter: a reader of light cannot tell it from "B2".
TEST(LitNames, NamesOfTwoScriptsThatLookAlikeAreLitByCodes) {
    for (const std::string same : {"В2", "Β2"}) {
        const auto names = lit_names({"B2", "C", same}, 5);
        for (const std::size_t i : {0U, 2U}) {
            EXPECT_TRUE(names[i].by_code) << same;
            EXPECT_NE(names[i].warning.find("looks the same"), std::string::npos) << names[i].warning;
        }
        EXPECT_NE(names[0].name, names[2].name);
        EXPECT_FALSE(names[1].by_code);
    }
    for (const auto& lit : lit_names({"Б2", "B2", "Ж2"}, 5)) EXPECT_FALSE(lit.by_code) << lit.name;
}

// Alef and a figure joined to it stand the same in light, whichever was written first.
TEST(LitNames, NamesThatStandTheSameFromTheRightAreLitByCodes) {
    const auto names = lit_names({"א1", "C", "1א"}, 5);
    EXPECT_TRUE(names[0].by_code);
    EXPECT_TRUE(names[2].by_code);
    EXPECT_FALSE(names[1].by_code);
    for (const auto& lit : lit_names({"א1", "א2"}, 5)) EXPECT_FALSE(lit.by_code) << lit.name;
}

TEST(Codes, NoCodeCanBeTakenForTheNameOfAnotherItem) {
    using Names = std::vector<std::string>;
    const auto codes = [](const Names& names) { return codes_of(names, names); };
    EXPECT_EQ(codes({"Drill 1", "Drill 2", "Drill 3"}), (Names{"#1", "#2", "#3"})) << "each its own number";
    // A line before the holes: #2 would be Drill 1.
    EXPECT_EQ(codes({"Cut", "Drill 1", "Drill 2"}), (Names{"#A", "#C", "#E"}));
    EXPECT_EQ(codes({"Cut", "Drill 001"}), (Names{"#A", "#C"})) << "leading zeros";
    EXPECT_EQ(codes({"Cut", "Drill 12"}), (Names{"#1", "#2"})) << "12 is not 1 or 2";
    EXPECT_EQ(codes({"A", "C", "Drill 1"}), (Names{"#E", "#F", "#H"})) << "letters that are names are passed over";
    EXPECT_EQ(codes({"x", "e1", "Drill 1"}), (Names{"#A", "#C", "#F"}));
    EXPECT_EQ(codes({"Cut", "切口一"}), (Names{"#A", "#C"})) << "a Chinese one";
    EXPECT_EQ(codes({"Cut", "Ⅰ"}), (Names{"#A", "#C"})) << "a Roman one";
    EXPECT_EQ(codes({"Разрез А", "Разрез 1"}), (Names{"#C", "#E"})) << "a Cyrillic A looks as the Latin one";
    Names many;
    for (int i = 0; i < 60; ++i) many.push_back("Drill " + std::to_string(60 - i));
    const auto of_many = codes(many);
    EXPECT_EQ(of_many[0], "#A");
    EXPECT_EQ(std::set<std::string>(of_many.begin(), of_many.end()).size(), 60u);
    for (const auto& code : of_many)
        EXPECT_EQ(code.find_first_of("0123456789BDGIJLOQSTZ"), std::string::npos)
            << code << ": it has a digit, or a letter that looks like one";
    // A name shortened in the midst of its number shows another number than it has.
    EXPECT_EQ(codes_of({"Drill 4512", "x"}, {"Dri…2", "x"}), (Names{"#A", "#C"}));
}

}  // namespace
}  // namespace planlight
