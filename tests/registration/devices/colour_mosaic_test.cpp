#include "registration/devices/colour_mosaic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace planlight {
namespace {

using Scene = std::function<double(int, int)>;

GrayImage taken(const Scene& light, double noise_grey = 2, int width = 320, int height = 240) {
    GrayImage picture(width, height);
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            picture.at(x, y) =
                static_cast<std::uint8_t>(std::clamp(std::lround(light(x, y) + noise_grey * normal(random)), 0L, 255L));
    return picture;
}

/// Red at (0, 0), blue at (1, 1).
Scene mosaic(const Scene& light, double red, double green, double blue) {
    return [=](int x, int y) { return light(x, y) * (x % 2 != y % 2 ? green : x % 2 == 0 ? red : blue); };
}

Scene head() {
    return [](int x, int y) {
        const double r2 = (std::pow(x - 160, 2) + std::pow(y - 120, 2)) / (100 * 100);
        return r2 < 1 ? 40 + 140 * std::sqrt(1 - r2) : 6;
    };
}

Scene chessboard(double square_px, double turn) {
    return [=](int x, int y) {
        const double u = (x * std::cos(turn) + y * std::sin(turn)) / square_px,
                     v = (y * std::cos(turn) - x * std::sin(turn)) / square_px;
        return (static_cast<int>(std::floor(u)) + static_cast<int>(std::floor(v))) % 2 == 0 ? 30 : 190;
    };
}

TEST(ColourMosaic, IsToldOfSkinOfAWhiteBoardAndOfBoth) {
    EXPECT_TRUE(is_colour_mosaic(taken(mosaic(head(), 1, 0.62, 0.42))));
    EXPECT_TRUE(is_colour_mosaic(taken(mosaic(head(), 0.42, 0.62, 1))));
    EXPECT_TRUE(is_colour_mosaic(taken(mosaic(chessboard(31, 0.2), 0.7, 1, 0.55))));
    EXPECT_TRUE(is_colour_mosaic(taken(mosaic(chessboard(31, 0.2), 1, 0.7, 1)))) << "red as bright as blue";
    const Scene shifted = [](int x, int y) { return mosaic(head(), 1, 0.62, 0.42)(x + 1, y); };
    EXPECT_TRUE(is_colour_mosaic(taken(shifted))) << "green first";
    const Scene skin = mosaic(head(), 1, 0.62, 0.42), drape = mosaic([](int, int) { return 90; }, 0.4, 1, 0.6);
    EXPECT_TRUE(is_colour_mosaic(taken([&](int x, int y) { return x < 160 ? skin(x, y) : drape(x, y); })));
}

TEST(ColourMosaic, IsNotSeenInGreyPictures) {
    EXPECT_FALSE(is_colour_mosaic({}));
    EXPECT_FALSE(is_colour_mosaic(taken([](int, int) { return 0; })));
    EXPECT_FALSE(is_colour_mosaic(taken(head())));
    for (const double noise : {5.0, 15.0, 40.0})
        EXPECT_FALSE(is_colour_mosaic(taken([](int, int) { return 25; }, noise))) << "noise of " << noise;
    for (const double square : {2.1, 3.0, 5.3, 16.0, 31.0})
        for (const double turn : {0.0, 0.1, M_PI / 4})
            EXPECT_FALSE(is_colour_mosaic(taken(chessboard(square, turn)))) << square << " px, turned " << turn;
}

TEST(ColourMosaic, IsNotSeenInFineTexture) {
    for (const double period : {2.05, 2.5, 3.0})
        for (const double turn : {0.0, 0.3, M_PI / 4, M_PI / 2})
            EXPECT_FALSE(is_colour_mosaic(taken([=](int x, int y) {
                return 100 + 90 * std::sin(2 * M_PI * (x * std::cos(turn) + y * std::sin(turn)) / period);
            }))) << period
                 << " px, turned " << turn;
}

TEST(ColourMosaic, IsNotSeenInInterlacedPicturesAndUnlikeColumns) {
    EXPECT_FALSE(is_colour_mosaic(taken([](int x, int y) { return head()(x, y) * (y % 2 == 0 ? 1 : 0.6); })));
    EXPECT_FALSE(is_colour_mosaic(taken([](int x, int y) { return head()(x, y) * (x % 2 == 0 ? 1 : 0.6); })));
    // Each field at its own moment: a head that moved sideways between them.
    EXPECT_FALSE(is_colour_mosaic(taken([](int x, int y) { return head()(x + (y % 2 == 0 ? 6 : 0), y); })));
}

}  // namespace
}  // namespace planlight
