// A report on screen and on paper: one content, in one order.
#include "app/report/document.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/app/read_pdf.h"

namespace planlight::test {
namespace {

Document a_document() {
    Chart chart({0, 10, "minutes of the clock"}, {0, 3, "mm beside the plan"});
    chart.line({{0, 1}, {10, 2}}, {20, 102, 58});
    chart.mark(4, "here it was dark", {163, 18, 31});
    Document document{"Match of Jürgen Müßig and Мария Иванова"};
    document.verdict = {PageVerdict::Kind::look, "Look at it before it is used.", {"The board was bent."}};
    document.facts = {{"Rig", "rig.json"}, {"Empty", ""}, {"Operator", "Dr. Łukasz"}};
    document.blocks = {
        DocumentHeading{"Devices"},
        DocumentTable{{{"Device"}, {"Off by"}}, {{{"left camera"}, {"0.12 px", Tone::good}}}},
        DocumentText{"Measured on one morning.", Tone::quiet},
        DocumentScale{{{0, 0, 255}, {255, 0, 0}}, {{0, "0 mm"}, {1, "0.5 mm and more"}}},
        DocumentKey{"Poses:", {{{9, 9, 9}, "pose-01"}, {{99, 9, 9}, "pose-02"}}},
        DocumentFigures{
            {{"The head", "from the left", RgbImage(40, 30, {9, 99, 9})}, {"Course", "by the clock", chart}}},
        NewSheet{},
        DocumentHeading{"On the second sheet"},
    };
    document.signed_by = {"Looked at and accepted by"};
    document.foot = "Planlight. For research.";
    return document;
}

/// What both say, from the top to the bottom.
const std::vector<std::string> kInOrder{"Match of Jürgen Müßig and Мария Иванова",
                                        "Look at it before it is used.",
                                        "The board was bent.",
                                        "Rig",
                                        "rig.json",
                                        "Dr. Łukasz",
                                        "Devices",
                                        "Device",
                                        "Off by",
                                        "left camera",
                                        "0.12 px",
                                        "Measured on one morning.",
                                        "0 mm",
                                        "0.5 mm and more",
                                        "Poses:",
                                        "pose-01",
                                        "pose-02",
                                        "The head",
                                        "from the left",
                                        "On the second sheet",
                                        "Looked at and accepted by",
                                        "Date, time",
                                        "Signature"};

void expect_in_order(const std::string& text) {
    std::size_t from = 0;
    for (const std::string& next : kInOrder) {
        const std::size_t at = text.find(next, from);
        ASSERT_NE(at, std::string::npos) << next << " is missing, or stands too early";
        from = at + next.size();
    }
    for (const char* of_the_chart : {"minutes of the clock", "mm beside the plan", "here it was dark", "Course"})
        EXPECT_NE(text.find(of_the_chart), std::string::npos) << of_the_chart;
    EXPECT_EQ(text.find("Empty"), std::string::npos) << "a fact without a value is left out";
}

TEST(Document, SaysTheSameInTheSameOrderOnScreenAndOnPaper) {
    Document document = a_document();
    for (const bool made_of_sheets : {false, true}) {
        document.made_of_sheets = made_of_sheets;
        const std::string html = html_of(document);
        expect_in_order(html.substr(html.find("<body>")));
        expect_in_order(text_of(pdf_of(document)));
    }
}

TEST(Document, TheFirstSheetHasTheVerdictWithItsShapeAndEverySheetItsNumber) {
    const auto sheets = sheets_of(pdf_of(a_document()));
    ASSERT_EQ(sheets.size(), 2U);
    EXPECT_NE(sheets[0].find("⚠ Look at it before it is used."), std::string::npos) << sheets[0];
    EXPECT_NE(sheets[0].find("Planlight. For research. Sheet 1 of 2"), std::string::npos);
    EXPECT_NE(sheets[1].find("Sheet 2 of 2"), std::string::npos);
    EXPECT_NE(sheets[1].find("On the second sheet"), std::string::npos);
}

TEST(Document, APaperIsA4OrLetter) {
    const std::string a4 = pdf_of(a_document()), letter = pdf_of(a_document(), PaperSize::letter);
    EXPECT_NE(a4.find("/MediaBox [ 0 0 595.276 841.89"), std::string::npos);
    EXPECT_NE(letter.find("/MediaBox [ 0 0 612 792"), std::string::npos);
}

TEST(Document, WhatIsMadeOfSheetsKeepsToThemWithSmallerPictures) {
    Document document{"Two sheets"};
    document.blocks = {NewSheet{}};
    for (int row = 0; row < 4; ++row)
        document.blocks.emplace_back(DocumentFigures{{{"a", "", RgbImage(10, 10)}, {"b", "", RgbImage(10, 10)}}});
    document.blocks.emplace_back(DocumentFigures{{{"c", "", RgbImage(10, 10)}}});
    EXPECT_GT(sheets_of(pdf_of(document)).size(), 2U);
    document.blocks.pop_back();
    document.made_of_sheets = true;
    EXPECT_EQ(sheets_of(pdf_of(document)).size(), 2U);
    EXPECT_EQ(sheets_of(pdf_of(document, PaperSize::letter)).size(), 2U);
}

TEST(Document, ALongTableIsBrokenBetweenItsRowsUnderItsNames) {
    Document document{"Many rows"};
    DocumentTable table{{{"Item"}, {"Name of a column"}}, {}};
    for (int i = 0; i < 150; ++i)
        table.rows.push_back(
            {{fmt::format("item-{}-of-many", i)},
             {fmt::format("begin{} of a sentence that is longer than the line that it stands on, so that "
                          "it needs a second line at least, and goes on there until its end{}",
                          i, i)}});
    document.blocks = {DocumentHeading{"Rows"}, table};
    const auto sheets = sheets_of(pdf_of(document));
    ASSERT_GT(sheets.size(), 2U);
    int rows = 0;
    for (const std::string& sheet : sheets) {
        EXPECT_NE(sheet.find("Name of a column"), std::string::npos) << "the names stand on each sheet";
        for (int i = 0; i < 150; ++i) {
            if (sheet.find(fmt::format("item-{}-of-many ", i)) == std::string::npos) continue;
            ++rows;
            EXPECT_NE(sheet.find(fmt::format("begin{} ", i)), std::string::npos);
            EXPECT_NE(sheet.find(fmt::format("end{} ", i)), std::string::npos) << "row " << i << " is torn";
        }
    }
    EXPECT_EQ(rows, 150) << "each stands there once";
}

TEST(Document, ACellThatNoSheetCanHoldGoesOnOnTheNextAndLosesNoWord) {
    std::string endless;
    for (int i = 0; i < 3000; ++i) endless += fmt::format("word{} ", i);
    Document document{"A high cell"};
    document.blocks = {DocumentTable{{{"At"}, {"What"}}, {{{"0:00:12"}, {endless}}, {{"0:00:13"}, {"the next"}}}}};
    const std::string text = text_of(pdf_of(document));
    for (int i = 0; i < 3000; ++i)
        ASSERT_NE(text.find(fmt::format("word{} ", i)), std::string::npos) << "word " << i << " is lost";
    EXPECT_NE(text.find("the next"), std::string::npos);
}

TEST(Document, WithoutAnythingItIsOneSheetWithATitle) {
    Document document{"Nothing"};
    document.blocks = {DocumentFigures{}, DocumentTable{}, DocumentKey{}, DocumentScale{}, NewSheet{}, NewSheet{}};
    const auto sheets = sheets_of(pdf_of(document));
    ASSERT_LE(sheets.size(), 2U) << "an empty sheet is not left behind by another";
    EXPECT_NE(sheets[0].find("Nothing"), std::string::npos);
    EXPECT_NE(html_of(document).find("<h1>Nothing</h1>"), std::string::npos);
}

TEST(Document, NoPlaceOfARowStaysEmpty) {
    const DocumentFigure square{"", "", RgbImage(10, 10)}, wide{"", "", RgbImage(30, 10)};
    const auto rows = [](std::vector<DocumentFigure> figures, int columns) {
        std::vector<std::pair<std::size_t, bool>> counted;
        for (const FigureRow& row : rows_of({std::move(figures), columns}))
            counted.emplace_back(row.figures.size(), row.wide);
        return counted;
    };
    using Rows = std::vector<std::pair<std::size_t, bool>>;
    EXPECT_EQ(rows({square, square, square}, 2), (Rows{{2, false}, {1, true}}));
    EXPECT_EQ(rows({square, wide, square, square}, 2), (Rows{{1, true}, {1, true}, {2, false}}));
    EXPECT_EQ(rows({wide, wide, wide, wide}, 3), (Rows{{3, false}, {1, false}}));
    EXPECT_TRUE(rows({}, 2).empty());
}

}  // namespace
}  // namespace planlight::test
