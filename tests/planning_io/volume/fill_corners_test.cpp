#include "planning_io/volume/fill_corners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

/// A head of 40 HU with a place of 0 in it, air round it, and beyond a circle of 28 voxels exactly 0.
Volume round_field(bool hu) {
    Volume volume;
    volume.modality = hu ? "CT" : "MR";
    volume.is_hu = hu;
    volume.size = {64, 64, 20};
    for (int k = 0; k < 20; ++k)
        for (int j = 0; j < 64; ++j)
            for (int i = 0; i < 64; ++i) {
                const double off = std::hypot(i - 31.5, j - 31.5);
                volume.values.push_back(off < 3 ? 0.F : off < 18 ? 40.F : off < 28 ? -1000.F : 0.F);
            }
    return volume;
}

TEST(FillCorners, WhatLiesBeyondARoundFieldIsAirAndWaterInTheHeadStays) {
    Volume ct = round_field(true);
    fill_corners(ct);
    EXPECT_EQ(ct.at(0, 0, 5), -1000);
    EXPECT_EQ(ct.at(63, 30, 19), -1000);
    EXPECT_EQ(ct.at(31, 31, 5), 0);
    ASSERT_EQ(ct.notes.size(), 1U);
    EXPECT_NE(ct.notes[0].find("were made air"), std::string::npos);
    fill_corners(ct);
    EXPECT_EQ(ct.notes.size(), 1U) << "there is nothing left to fill";
}

TEST(FillCorners, OfWhatIsNoCtNothingIsChanged) {
    Volume mr = round_field(false);
    const auto before = mr.values;
    fill_corners(mr);
    EXPECT_TRUE(std::equal(before.begin(), before.end(), mr.values.begin()));
    EXPECT_TRUE(mr.notes.empty());
}

}  // namespace
}  // namespace planlight
