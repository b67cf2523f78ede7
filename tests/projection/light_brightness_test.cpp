#include "projection/light_brightness.h"

#include <gtest/gtest.h>

namespace planlight {
namespace {

/// A look at lines of full light that add `light` of 255 to skin of `skin` of 255, lit with `share` of it.
LightCheck look(double light, double skin, double share, int seen = 20) {
    LightCheck check;
    check.expected = 20;
    check.seen = seen;
    check.background = skin;
    check.brighter = check.fainter = share * light / skin;
    return check;
}

/// The share that is reached under such lamps, and the largest change on the way.
double settles(LightBrightness& brightness, double light, double skin, double* largest_step = nullptr) {
    for (int i = 0; i < 200; ++i) {
        const double before = brightness.share();
        brightness.look(look(light, skin, before));
        if (largest_step) *largest_step = std::max(*largest_step, std::abs(brightness.share() / before - 1));
    }
    return brightness.share();
}

TEST(LightBrightness, UnderTheatreLampsAllOfIt) {
    LightBrightness brightness;
    EXPECT_EQ(settles(brightness, 100, 80), 1);
    EXPECT_EQ(settles(brightness, 100, 27), 1);
}

TEST(LightBrightness, InADarkRoomLinesStayTwoAndAHalfToFourTimesAsBrightAgainAsTheSkin) {
    LightBrightness brightness;
    double step = 0;
    const double share = settles(brightness, 200, 20, &step);
    EXPECT_LE(share * 200 / 20, 4);
    EXPECT_GE(share * 200 / 20, 2.5);
    EXPECT_LE(step, 0.0501) << "nobody shall see it flicker";
    const double before = share;
    for (int i = 0; i < 50; ++i) EXPECT_EQ(brightness.look(look(200, 20, before)), before) << "it rests there";
}

TEST(LightBrightness, KeepsAShareOfTheLightInAnyRoom) {
    LightBrightness brightness;
    EXPECT_EQ(settles(brightness, 250, 1), 0.3);
}

TEST(LightBrightness, ComesBackWhenTheLampsGoOnOrTheLightIsNotSeen) {
    LightBrightness brightness;
    ASSERT_EQ(settles(brightness, 250, 5), 0.3);
    int looks = 0;
    while (brightness.share() < 1 && looks < 100) {
        brightness.look(look(100, 80, brightness.share()));
        ++looks;
    }
    EXPECT_LE(looks, 30) << "three seconds at ten looks a second";
    ASSERT_EQ(settles(brightness, 250, 5), 0.3);
    for (int i = 0; i < 30; ++i) brightness.look(look(250, 5, brightness.share(), 3));
    EXPECT_EQ(brightness.share(), 1);
}

TEST(LightBrightness, LinesThatACameraHardlySeesAreNotDimmed) {
    LightBrightness brightness;
    EXPECT_EQ(settles(brightness, 40, 2), 1);
}

}  // namespace
}  // namespace planlight
