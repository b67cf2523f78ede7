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
