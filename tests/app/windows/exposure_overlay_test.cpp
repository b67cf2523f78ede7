#include "app/windows/exposure_overlay.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace planlight {
namespace {

bool is_grey(const Rgb& pixel) {
    return pixel[0] == pixel[1] && pixel[1] == pixel[2];
}

TEST(ExposureOverlay, WhatCanBeMeasuredStaysAsItWasExposed) {
    GrayImage picture(40, 30);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) picture.at(x, y) = static_cast<std::uint8_t>(10 + 6 * x);
    const RgbImage shown = exposure_overlay(picture, 1);
    for (int x = 0; x < 40; ++x) EXPECT_EQ(shown.at(x, 7), (Rgb{picture.at(x, 7), picture.at(x, 7), picture.at(x, 7)}));
}

TEST(ExposureOverlay, WhatIsTooBrightHasStripesAndWhatIsTooDarkAColour) {
    GrayImage picture(40, 30, 255);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 20; ++x) picture.at(x, y) = 3;
    const RgbImage shown = exposure_overlay(picture, 1);
    int red = 0, white = 0;
    for (int x = 20; x < 40; ++x) (is_grey(shown.at(x, 10)) ? white : red) += 1;
    EXPECT_NEAR(red, white, 4) << "half of a zebra is picture";
    for (int x = 0; x < 20; ++x) EXPECT_GT(shown.at(x, 10)[2], shown.at(x, 10)[0] + 50) << "blue";
}

// Highlights of one pixel are seen though the picture is shown a quarter as large.
TEST(ExposureOverlay, OneSaturatedPixelMarksTheCellThatItIsShownIn) {
    GrayImage row(64, 64, 80);
    for (int x = 0; x < 64; x += 4) row.at(x, 32) = 254;
    const RgbImage shown = exposure_overlay(row, 4);
    EXPECT_EQ(shown.width, 16);
    EXPECT_EQ(std::count_if(shown.pixels.begin(), shown.pixels.end(), [](const Rgb& pixel) { return !is_grey(pixel); }),
              8)
        << "of 16 cells in a row every second four";
}

}  // namespace
}  // namespace planlight
