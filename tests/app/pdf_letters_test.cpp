#include "app/report/pdf_letters.h"

#include <gtest/gtest.h>

#include "app/report/document.h"

namespace planlight {
namespace {

double left_of(const Sign& sign) {
    double least = 1e9;
    for (const auto& outline : sign.outlines)
        for (const auto& p : outline) least = std::min(least, p.x());
    return least;
}

TEST(PdfLetters, WhatTheFontHasStaysTextThatCanBeSearched) {
    for (const char* line : {"", "Osteotomy B3, 12.5 mm deep", "Łukasz Żółć – Мария Ωμέγα, ø 7 mm ≤ 1 °", " a  b "}) {
        const auto pieces = letters_of(line);
        ASSERT_EQ(pieces.size(), 1U) << line;
        EXPECT_EQ(pieces[0].text, line);
        EXPECT_FALSE(pieces[0].outline) << line;
    }
}

TEST(PdfLetters, OnlyTheWordsOfOtherScriptsAreDrawn) {
    const auto pieces = letters_of("Plan of 王小明 of today");
    ASSERT_EQ(pieces.size(), 3U);
    EXPECT_EQ(pieces[0].text, "Plan of ");
    ASSERT_TRUE(pieces[1].outline);
    EXPECT_EQ(pieces[1].outline->signs.size(), 3U);
    EXPECT_EQ(pieces[2].text, "of today");
    EXPECT_FALSE(pieces[2].outline);
}

TEST(PdfLetters, HebrewAndArabicAreReadFromTheRight) {
    const auto name = letters_of("אב"), bet = letters_of("ב"), alef = letters_of("א");
    ASSERT_TRUE(name.at(0).outline && bet.at(0).outline && alef.at(0).outline);
    ASSERT_EQ(name[0].outline->signs.size(), 2U);
    const Sign& leftmost = name[0].outline->signs[0];  // the second letter of the name
    EXPECT_NEAR(left_of(leftmost), left_of(bet[0].outline->signs[0]), 1e-9);
    EXPECT_EQ(leftmost.outlines.size(), bet[0].outline->signs[0].outlines.size());
    EXPECT_LT(left_of(leftmost), left_of(name[0].outline->signs[1]));

    const auto arabic = letters_of("محمد, 12 mm");
    ASSERT_EQ(arabic.size(), 1U);  // one line, for its words change places
    ASSERT_TRUE(arabic[0].outline);
    double apart = 0;  // letters that stand alone are wider than joined ones
    for (const char* letter : {"م", "ح", "م", "د"}) apart += letters_of(letter).at(0).outline->width;
    EXPECT_LT(letters_of("محمد").at(0).outline->width, apart);
}

TEST(PdfLetters, ASheetTakesThemAll) {
    Document document{"Report of 王小明"};
    document.foot = "محمد";
    document.blocks = {
        DocumentHeading{"आदेश"},
        DocumentText{"王小明王小明王小明王小明王小明王小明王小明王小明王小明王小明王小明王小明王小明王小明王小明"},
        DocumentTable{{{"名"}, {"اسم"}}, {{{"患者"}, {"محمد, 12 mm"}}}}};
    const std::string bytes = pdf_of(document);
    EXPECT_TRUE(bytes.starts_with("%PDF"));
    Document latin{"Report of"};
    latin.blocks = {DocumentHeading{"h"}};
    EXPECT_GT(bytes.size(), pdf_of(latin).size() + 2000);  // the outlines are in it
}

}  // namespace
}  // namespace planlight
