#include "app/commands/capture_conversion.h"

#include <gtest/gtest.h>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

CaptureFolder folder_of(int phase_steps) {
    CaptureFolder folder;
    folder.projector_width = 800, folder.projector_height = 600;
    folder.phase_steps = phase_steps;
    return folder;
}

std::vector<std::string> names_of(const std::vector<StripePattern>& patterns) {
    std::vector<std::string> names;
    for (const StripePattern& pattern : patterns) names.push_back(pattern.name);
    return names;
}

// `scan` and `calibrate` ask both functions, so that one capture.json means one sequence to both.
TEST(CaptureConversion, AGrayCodeWithoutFringesCountsSingleProjectorPixelsWhateverPeriodIsSaid) {
    CaptureFolder folder = folder_of(0);
    for (const double period : {2.0, 16.0}) {
        folder.phase_period_px = period;
        const StripeSettings stripes = stripes_of(folder);
        EXPECT_EQ(stripes.phase_period_px, 2);
        EXPECT_EQ(patterns_of(stripes, "capture.json").size(), 2u + 2 * 10 + 2 * 10);
        EXPECT_EQ(gray_bits(stripes, false), 10);
    }
    folder.inverse = folder.rows = false;
    const auto columns = names_of(patterns_of(stripes_of(folder), "capture.json"));
    ASSERT_EQ(columns.size(), 2u + 10);
    EXPECT_EQ(columns[2], "column-gray-0");
    EXPECT_EQ(columns[11], "column-gray-9");
    folder.names = columns;
    folder.left.assign(columns.size(), GrayImage(4, 4));
    EXPECT_EQ(names_of(scan_capture_from(folder, "capture.json").partial), columns);
}

// A code centred in a larger power of two: 800 columns from 112 on have 10 bits, 600 rows from 212 on 10, 1280 from 384
// on 11.
TEST(CaptureConversion, ACodeThatBeginsElsewhereHasTheBitsOfItsGreatestNumber) {
    CaptureFolder folder = folder_of(0);
    folder.begins_at_column = 112, folder.begins_at_row = 212;
    EXPECT_EQ(patterns_of(stripes_of(folder), "capture.json").size(), 2u + 2 * 10 + 2 * 10);
    folder.begins_at_column = 300;
    EXPECT_EQ(patterns_of(stripes_of(folder), "capture.json").size(), 2u + 2 * 11 + 2 * 10);
}

/// What the message says is missing, and what goes with it.
std::string refusal_of(const CaptureFolder& folder) {
    try {
        scan_capture_from(folder, "capture.json");
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

TEST(CaptureConversion, WhatIsNotNamedTakesWithItWhatCountsOnIt) {
    CaptureFolder whole = folder_of(0);
    whole.names = names_of(patterns_of(stripes_of(whole), "capture.json"));
    const auto without = [&](const std::vector<std::string>& left_out) {
        CaptureFolder folder = whole;
        for (const std::string& name : left_out) std::erase(folder.names, name);
        folder.left.assign(folder.names.size(), GrayImage(4, 4));
        return folder;
    };
    EXPECT_NE(
        refusal_of(without({"column-gray-8-inverse"})).find("column-gray-8, column-gray-9, column-gray-9-inverse"),
        std::string::npos)
        << refusal_of(without({"column-gray-8-inverse"}));
    EXPECT_EQ(refusal_of(without({"column-gray-8", "column-gray-8-inverse", "column-gray-9", "column-gray-9-inverse"})),
              "");
    EXPECT_NE(refusal_of(without({"white", "row-gray-3"})).find("white, row-gray-3"), std::string::npos)
        << "both at once";
    CaptureFolder columns = whole;
    std::erase_if(columns.names, [](const std::string& name) { return name.starts_with("row"); });
    columns.left.assign(columns.names.size(), GrayImage(4, 4));
    EXPECT_FALSE(scan_capture_from(columns, "capture.json").stripes.rows) << "all rows may be missing";
}

TEST(CaptureConversion, WithFringesTheSequenceIsThatOfTheScan) {
    CaptureFolder folder = folder_of(8);
    folder.phase_period_px = 20;
    const StripeSettings stripes = stripes_of(folder);
    EXPECT_EQ(stripes.phase_period_px, 20);
    EXPECT_EQ(names_of(patterns_of(stripes, "capture.json")), names_of(stripe_sequence(stripes)));
    folder.phase_steps = 2;
    EXPECT_THROW(patterns_of(stripes_of(folder), "capture.json"), InputError) << "too few shifts";
    folder.phase_steps = 0;
    folder.order_periods_px = {19.8};
    EXPECT_THROW(patterns_of(stripes_of(folder), "capture.json"), InputError) << "further fringes without a first";
}

}  // namespace
}  // namespace planlight
