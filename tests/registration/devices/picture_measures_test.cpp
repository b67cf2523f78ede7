// What is measured of a single picture while a camera is aimed, focused and exposed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "registration/devices/clipped_pixels.h"
#include "registration/devices/focus_measure.h"

namespace planlight {
namespace {

/// A picture as light: no grey steps, no noise.
struct Light {
    int width = 0, height = 0;
    std::vector<double> at;
    double operator()(int x, int y) const {
        x = std::clamp(x, 0, width - 1);
        y = std::clamp(y, 0, height - 1);
        return at[static_cast<std::size_t>(y * width + x)];
    }
};

Light blurred(const Light& light, double sigma) {
    if (sigma <= 0) return light;
    const int reach = static_cast<int>(std::ceil(4 * sigma));
    std::vector<double> kernel;
    double sum = 0;
    for (int i = -reach; i <= reach; ++i) kernel.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    for (const double k : kernel) sum += k;
    Light along = light, out = light;
    const auto pass = [&](const Light& from, Light& to, int dx, int dy) {
        for (int y = 0; y < from.height; ++y)
            for (int x = 0; x < from.width; ++x) {
                double value = 0;
                for (int i = -reach; i <= reach; ++i)
                    value += kernel[static_cast<std::size_t>(i + reach)] * from(x + i * dx, y + i * dy);
                to.at[static_cast<std::size_t>(y * from.width + x)] = value / sum;
            }
    };
    pass(light, along, 1, 0);
    pass(along, out, 0, 1);
    return out;
}

/// Discs of all sizes and greys over one another (dead leaves: as natural pictures are), from 20 to 180 grey values,
/// as a lens in focus draws them.
Light texture(unsigned seed) {
    Light light{320, 240, std::vector<double>(320 * 240, 100)};
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(0, 1);
    for (int disc = 0; disc < 1500; ++disc) {
        const double radius = 2 / std::max(0.05, share(random)), grey = 20 + 160 * share(random);
        const double cx = 320 * share(random), cy = 240 * share(random);
        for (int y = std::max(0, static_cast<int>(cy - radius)); y < std::min(240.0, cy + radius); ++y)
            for (int x = std::max(0, static_cast<int>(cx - radius)); x < std::min(320.0, cx + radius); ++x)
                if (std::hypot(x - cx, y - cy) < radius) light.at[static_cast<std::size_t>(y * 320 + x)] = grey;
    }
    return blurred(light, 0.7);
}

/// As a camera takes it: exposure, shot noise of 8 electrons a grey value, read noise of half a grey value, 8 bits.
GrayImage taken(const Light& light, double exposure, unsigned seed) {
    GrayImage picture(light.width, light.height);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < light.at.size(); ++i) {
        const double grey = exposure * light.at[i];
        const double noisy = grey + std::sqrt(grey / 8 + 0.25) * normal(random);
        picture.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(noisy), 0L, 255L));
    }
    return picture;
}

TEST(FocusMeasure, FallsWithEveryBlurOfThePicture) {
    for (const unsigned seed : {1U, 2U, 3U}) {
        const Light sharp = texture(seed);
        double before = 1e9;
        for (const double sigma : {0.0, 0.4, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0}) {
            const double now = focus_measure(taken(blurred(sharp, sigma), 1, 100 + seed));
            EXPECT_LT(now, before) << "blur of " << sigma << " px";
            before = now;
        }
        EXPECT_LT(before, 0.4 * focus_measure(taken(sharp, 1, seed))) << "a blur of 6 px is told at once";
    }
}

// A lens is focused before it is exposed: the best value must stay the best. 3 %: the steps of 8 bits, and what the
// noise's own estimate scatters.
TEST(FocusMeasure, StaysWhenTheExposureIsHalvedOrAQuarter) {
    for (const unsigned seed : {1U, 2U, 3U})
        for (const double sigma : {0.0, 1.0, 3.0}) {
            const Light light = blurred(texture(seed), sigma);
            const double full = focus_measure(taken(light, 1, seed)),
                         half = focus_measure(taken(light, 0.5, 50 + seed)),
                         quarter = focus_measure(taken(light, 0.25, 70 + seed));
            EXPECT_NEAR(half / full, 1, 0.03) << "blur of " << sigma << " px";
            EXPECT_NEAR(quarter / full, 1, 0.06) << "blur of " << sigma << " px";
        }
}

// A flat wall has nothing to be sharp: noise alone is worth less than a third of what a texture is that is blurred by 4
// px.
TEST(FocusMeasure, OfNoiseAloneIsNext) {
    const Light flat{320, 240, std::vector<double>(320 * 240, 60)};
    EXPECT_LT(focus_measure(taken(flat, 1, 5)), 0.5);
    EXPECT_GT(focus_measure(taken(blurred(texture(1), 4), 1, 5)), 1.5);
}

TEST(FocusMeasure, LooksAtTheMiddleAloneAndNotAtWhatIsSaturated) {
    GrayImage picture(320, 240, 60);
    for (int y = 0; y < 240; ++y)
        for (int x = 0; x < 70; ++x) picture.at(x, y) = x % 2 == 0 ? 20 : 200;
    EXPECT_EQ(focus_measure(picture), 0) << "stripes at the edge";
    for (int y = 100; y < 140; ++y)
        for (int x = 140; x < 180; ++x) picture.at(x, y) = 255;
    EXPECT_LT(focus_measure(picture), 1e-3) << "an edge of what is saturated has no true slope";
    EXPECT_EQ(focus_measure(GrayImage(320, 240, 0)), 0);
    EXPECT_EQ(focus_measure(GrayImage(320, 240, 255)), 0);
    EXPECT_EQ(focus_measure(GrayImage(8, 8, 100)), 0) << "too small to have a middle";
}

TEST(ClippedShares, CountWhatIsTooBrightAndTooDark) {
    GrayImage picture(10, 10, 100);
    for (int x = 0; x < 10; ++x) picture.at(x, 0) = x < 3 ? 255 : 254;
    for (int x = 0; x < 5; ++x) picture.at(x, 1) = static_cast<std::uint8_t>(5 + x);
    picture.at(9, 9) = 253;
    const ClippedShares shares = clipped_shares(picture);
    EXPECT_DOUBLE_EQ(shares.too_bright, 0.10);
    EXPECT_DOUBLE_EQ(shares.too_dark, 0.05);
    EXPECT_EQ(clipped_shares({}).too_dark, 0);
}

}  // namespace
}  // namespace planlight
