#include "registration/devices/repeated_picture.h"

#include <gtest/gtest.h>

namespace planlight {
namespace {

GrayImage ramp(int width = 61, int height = 40) {
    GrayImage picture(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) picture.at(x, y) = static_cast<std::uint8_t>(3 * x + y);
    return picture;
}

TEST(RepeatedPicture, IsTheOneBeforeAndNoOther) {
    RepeatedPicture repeated;
    EXPECT_FALSE(repeated.is(ramp()));
    EXPECT_TRUE(repeated.is(ramp()));
    EXPECT_TRUE(repeated.is(ramp())) << "however often";
    GrayImage other = ramp();
    ++other.at(60, 39);
    EXPECT_FALSE(repeated.is(other)) << "one grey step of one pixel, the last of all";
    EXPECT_FALSE(repeated.is(ramp())) << "the one before was another";
    repeated.forget();
    EXPECT_FALSE(repeated.is(ramp()));
}

TEST(RepeatedPicture, OfAnotherSizeOrOfOneGreyIsNone) {
    RepeatedPicture repeated;
    repeated.is(GrayImage(64, 8, 0));
    EXPECT_FALSE(repeated.is(GrayImage(64, 8, 0))) << "a covered lens";
    EXPECT_FALSE(repeated.is(GrayImage(64, 8, 255)));
    GrayImage hot(200, 100, 2);
    hot.at(17, 50) = 90, hot.at(150, 3) = 60;
    repeated.is(hot);
    EXPECT_FALSE(repeated.is(hot)) << "a covered lens, and two hot pixels";
    EXPECT_FALSE(repeated.is(GrayImage()));
    EXPECT_FALSE(repeated.is(GrayImage()));
    GrayImage wide(16, 8, 0), narrow(8, 16, 0);
    wide.at(0, 0) = narrow.at(0, 0) = 1;
    repeated.is(wide);
    EXPECT_FALSE(repeated.is(narrow));
}

}  // namespace
}  // namespace planlight
