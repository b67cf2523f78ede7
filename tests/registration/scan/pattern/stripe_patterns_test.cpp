#include "registration/scan/pattern/stripe_patterns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "registration/scan/decode/decode_stripes.h"

namespace planlight {
namespace {

StripeSettings stripes(int width, int height) {
    StripeSettings s;
    s.width = width;
    s.height = height;
    return s;
}

/// What a perfect camera in the projector's own place would see, through the projector's gamma.
std::vector<GrayImage> seen_by_the_projector(const StripeSettings& s, double gamma) {
    std::vector<GrayImage> frames;
    for (const StripePattern& pattern : stripe_sequence(s)) {
        const RgbImage picture = draw_stripes(s, pattern);
        GrayImage frame(s.width, s.height);
        for (std::size_t i = 0; i < frame.pixels.size(); ++i)
            frame.pixels[i] =
                static_cast<std::uint8_t>(std::lround(15 + 200 * std::pow(picture.pixels[i][1] / 255.0, gamma)));
        frames.push_back(frame);
    }
    return frames;
}

TEST(StripePatterns, OrderIsWhiteBlackColumnsRowsAndNamesAreUnique) {
    const auto sequence = stripe_sequence(stripes(1920, 1080));
    ASSERT_EQ(sequence.size(), 2u + 2 * (2 * 8 + 8));  // 240 and 135 half periods: 8 bits each
    EXPECT_EQ(sequence[0].name, "white");
    EXPECT_EQ(sequence[1].name, "black");
    EXPECT_EQ(sequence[2].name, "column-gray-0");
    EXPECT_EQ(sequence[3].name, "column-gray-0-inverse");
    EXPECT_EQ(sequence.back().name, "row-phase-7");
    std::set<std::string> names;
    for (const auto& p : sequence) names.insert(p.name);
    EXPECT_EQ(names.size(), sequence.size());
    EXPECT_EQ(stripe_sequence(stripes(800, 600)).size(), 2u + 2 * (2 * 7 + 8));
}

TEST(StripePatterns, OneGrayBitFlipsAtEveryBorder) {
    const StripeSettings s = stripes(800, 600);
    std::vector<RgbImage> bits;
    for (const auto& p : stripe_sequence(s))
        if (p.kind == StripePattern::Kind::gray_bit && !p.along_rows) bits.push_back(draw_stripes(s, p));
    for (int x = 1; x < s.width; ++x) {
        int flips = 0;
        for (const auto& picture : bits) flips += picture.at(x, 0) != picture.at(x - 1, 0) ? 1 : 0;
        EXPECT_EQ(flips, x % 8 == 0 ? 1 : 0) << x;
    }
}

TEST(StripePatterns, FringesUseTheWholeRange) {
    const StripeSettings s = stripes(800, 600);
    const RgbImage picture = draw_stripes(s, stripe_sequence(s).back());
    int low = 255, high = 0;
    for (const auto& p : picture.pixels) {
        low = std::min<int>(low, p[0]);
        high = std::max<int>(high, p[0]);
    }
    EXPECT_EQ(low, 0);
    EXPECT_EQ(high, 255);
}

TEST(StripePatterns, SettingsThatMakeNoCodeAreRefused) {
    StripeSettings s = stripes(800, 600);
    s.phase_steps = 2;
    EXPECT_THROW(stripe_sequence(s), std::invalid_argument);
    s = stripes(0, 600);
    EXPECT_THROW(stripe_sequence(s), std::invalid_argument);
    s = stripes(800, 600);
    s.phase_period_px = 1;
    EXPECT_THROW(draw_stripes(s, {StripePattern::Kind::white, false, 0, "white"}), std::invalid_argument);
    EXPECT_THROW(draw_stripes(stripes(800, 600), {StripePattern::Kind::gray_bit, false, 7, "eighth"}),
                 std::invalid_argument);
}

class EveryPixelIsItself : public testing::TestWithParam<std::tuple<int, int, bool, double, double>> {};

TEST_P(EveryPixelIsItself, ToAFiftiethOfAPixel) {
    const auto [width, height, inverse, period, gamma] = GetParam();
    StripeSettings s = stripes(width, height);
    s.inverse = inverse;
    s.phase_period_px = period;
    const DecodedView view = decode_stripes(seen_by_the_projector(s, gamma), s);
    EXPECT_EQ(view.decoded, static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    double worst = 0, sum = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
            ASSERT_FALSE(std::isnan(view.column[i])) << x << " " << y;
            worst = std::max({worst, std::abs(double{view.column[i]} - x), std::abs(double{view.row[i]} - y)});
            sum += double{view.column[i]} - x;
        }
    // Rounding to whole grey values at an amplitude of about 90: 0.29 * 0.5 / 90 radians, 0.004 pixels; worst case 4 x.
    EXPECT_LT(worst, 0.02);
    EXPECT_LT(std::abs(sum) / static_cast<double>(view.decoded), 0.002);
}

INSTANTIATE_TEST_SUITE_P(Sizes, EveryPixelIsItself,
                         testing::Values(std::tuple{800, 600, true, 16.0, 2.2}, std::tuple{1920, 1080, true, 16.0, 2.2},
                                         std::tuple{1920, 1080, false, 16.0, 1.0},
                                         std::tuple{641, 479, true, 16.0, 2.2}, std::tuple{800, 600, false, 24.0, 2.2},
                                         std::tuple{1280, 720, true, 20.0, 1.8}));

}  // namespace
}  // namespace planlight
