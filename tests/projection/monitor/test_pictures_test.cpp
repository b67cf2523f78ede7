#include "projection/monitor/test_pictures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

namespace planlight {
namespace {

Monitor monitor_of(int width, int height) {
    Monitor monitor;
    monitor.name = "HDMI-2";
    monitor.width = width;
    monitor.height = height;
    return monitor;
}

constexpr std::pair<int, int> kSizes[] = {{800, 600}, {1920, 1080}, {1281, 801}};

TEST(TestPictures, HaveTheProjectorsPixelsAndAreGrey) {
    for (const auto& [w, h] : kSizes)
        for (const TestPicture kind : kTestPictures) {
            const RgbImage picture = draw_test_picture(kind, monitor_of(w, h));
            EXPECT_EQ(picture.width, w);
            EXPECT_EQ(picture.height, h);
            bool lit = false;
            for (const Rgb& pixel : picture.pixels) lit = lit || pixel != Rgb{0, 0, 0};
            EXPECT_EQ(lit, kind != TestPicture::dark) << text_of(kind);
        }
}

TEST(TestPictures, TheFrameLightsTheOutermostPixelsAndNoneBesideThem) {
    for (const auto& [w, h] : kSizes) {
        const RgbImage picture = draw_test_picture(TestPicture::frame, monitor_of(w, h));
        const Rgb white{255, 255, 255}, black{0, 0, 0};
        for (int x = 0; x < w; ++x) {
            EXPECT_EQ(picture.at(x, 0), white);
            EXPECT_EQ(picture.at(x, h - 1), white);
            if (x > 0 && x < w - 1) {
                EXPECT_EQ(picture.at(x, 1), black);
            }
        }
        for (int y = 0; y < h; ++y) {
            EXPECT_EQ(picture.at(0, y), white);
            EXPECT_EQ(picture.at(w - 1, y), white);
            if (y > 0 && y < h - 1) {
                EXPECT_EQ(picture.at(w - 2, y), black);
            }
        }
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                EXPECT_EQ(picture.at(x, y), picture.at(w - 1 - x, y)) << "the cross stands in the very middle";
                EXPECT_EQ(picture.at(x, y), picture.at(x, h - 1 - y));
            }
        EXPECT_EQ(picture.at(w / 2, h / 2), white);
    }
}

// Round a circle of any star, as many spokes are met as it has: 36 that are lit and 36 that are not.
TEST(TestPictures, EveryStarHasItsSpokesAtEveryRadius) {
    for (const auto& [w, h] : kSizes) {
        const RgbImage picture = draw_test_picture(TestPicture::star, monitor_of(w, h));
        const auto stars = siemens_stars(w, h);
        ASSERT_EQ(stars.size(), 5U);
        for (const SiemensStar& star : stars)
            for (const double share : {0.5, 0.75, 0.95}) {
                int changes = 0;
                bool lit = false, before = false;
                for (int i = 0; i <= 20'000; ++i) {
                    const double turn = 2 * std::numbers::pi * i / 20'000;
                    const int x = static_cast<int>(std::lround(star.x + share * star.radius * std::cos(turn))),
                              y = static_cast<int>(std::lround(star.y + share * star.radius * std::sin(turn)));
                    const int value = picture.at(x, y)[0];
                    if (value > 170 || value < 85) lit = value > 170;  // between the two nothing has changed yet
                    changes += i > 0 && lit != before;
                    before = lit;
                }
                EXPECT_NEAR(changes, 2 * star.spokes, 1) << w << " x " << h << ", radius " << share * star.radius;
            }
    }
}

TEST(TestPictures, HalfOfAStarIsLight) {
    const RgbImage picture = draw_test_picture(TestPicture::star, monitor_of(800, 600));
    const SiemensStar star = siemens_stars(800, 600).front();
    double light = 0, area = 0;
    for (int y = 0; y < 600; ++y)
        for (int x = 0; x < 800; ++x)
            if (std::hypot(x - star.x, y - star.y) < star.radius - 1) light += picture.at(x, y)[0] / 255.0, area += 1;
    EXPECT_NEAR(light / area, 0.5, 0.01);
}

TEST(TestPictures, TheGreysRiseInEvenStepsFromBlackToWhite) {
    for (const auto& [w, h] : kSizes) {
        const RgbImage picture = draw_test_picture(TestPicture::steps, monitor_of(w, h));
        std::set<int> greys;
        for (int x = 0; x < w; ++x) {
            const Rgb pixel = picture.at(x, h / 2);
            EXPECT_TRUE(pixel[0] == pixel[1] && pixel[1] == pixel[2]);
            EXPECT_EQ(pixel, picture.at(x, 0));
            if (x > 0) {
                EXPECT_GE(pixel[0], picture.at(x - 1, h / 2)[0]);
            }
            greys.insert(pixel[0]);
        }
        ASSERT_EQ(greys.size(), static_cast<std::size_t>(kGreySteps));
        int expected = 0;
        for (const int value : greys) EXPECT_EQ(value, 17 * expected++) << "255 in 15 steps";
    }
}

TEST(TestPictures, TheNameTellsMonitorsApart) {
    Monitor other = monitor_of(800, 600);
    other.name = "DP-1";
    EXPECT_NE(draw_test_picture(TestPicture::name, monitor_of(800, 600), 1).pixels,
              draw_test_picture(TestPicture::name, other, 1).pixels);
}

TEST(TestPictures, AreCalledInCommandsAsTheyAreCalled) {
    for (const TestPicture kind : kTestPictures) EXPECT_EQ(test_picture_of(text_of(kind)), kind);
    EXPECT_FALSE(test_picture_of("stars"));
}

}  // namespace
}  // namespace planlight
