#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "registration/scan/decode/correspondence_map.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Map = std::function<Vector2d(double, double)>;

constexpr int kSize = 41, kMiddle = 20;

/// A view whose code is `code` at a pixel counted from the middle; all of it as noisy, and lit as `dimness` says.
DecodedView view_of(const Map& code, double sigma_px, const std::function<double(double, double)>& dimness = {}) {
    DecodedView view;
    view.width = view.height = kSize;
    for (int y = -kMiddle; y <= kMiddle; ++y)
        for (int x = -kMiddle; x <= kMiddle; ++x) {
            const Vector2d c = code(x, y);
            view.column.push_back(static_cast<float>(c.x()));
            view.row.push_back(static_cast<float>(c.y()));
            view.sigma_px.push_back(static_cast<float>(sigma_px));
            if (dimness) view.dimness.push_back(static_cast<float>(dimness(x, y)));
        }
    return view;
}

/// A surface that bends under straight stripes.
Vector2d bent(double x, double y) {
    return {400 + 1.1 * x + 0.2 * y + 0.02 * x * x - 0.03 * y * y + 0.01 * x * y,
            300 - 0.1 * x + 0.9 * y + 0.01 * x * x + 0.025 * y * y};
}

TEST(Correspondence, IsThatOfTheCentreOnABentSurface) {
    const auto local = correspondence_at(view_of(bent, 1e-4), kMiddle, kMiddle);
    ASSERT_TRUE(local && local->whole);
    EXPECT_NEAR(local->code.x(), 400, 1e-3);  // the mean of the 25 pixels is 0.02 px less
    EXPECT_NEAR(local->code.y(), 300, 1e-3);  // and here 0.07 px more
    EXPECT_NEAR(local->by_pixel(0, 0), 1.1, 1e-4);
    EXPECT_NEAR(local->by_pixel(1, 1), 0.9, 1e-4);
}

/// All neighbours are there two lines from the picture's rim as well; nearer, the plane is fitted to what there is.
TEST(Correspondence, IsTheSameBesideTheRimOfThePicture) {
    const Map flat = [](double x, double y) { return Vector2d(400 + 1.1 * x, 300 + 0.9 * y); };
    const DecodedView view = view_of(flat, 0.02);
    for (const int y : {0, 1, 2, 3, kSize - 4, kSize - 3, kSize - 2, kSize - 1})
        for (const int x : {0, 2, kMiddle, kSize - 3, kSize - 1}) {
            const auto local = correspondence_at(view, x, y);
            if (!local) continue;  // a corner has too few neighbours
            EXPECT_NEAR(local->code.x(), 400 + 1.1 * (x - kMiddle), 1e-3) << x << " " << y;
            EXPECT_NEAR(local->code.y(), 300 + 0.9 * (y - kMiddle), 1e-3) << x << " " << y;
            EXPECT_EQ(local->whole, std::min({x, y, kSize - 1 - x, kSize - 1 - y}) >= 2);
        }
    EXPECT_TRUE(correspondence_at(view, kMiddle, kSize - 3));
}

/// What it says of its own noise is so, from little noise (a quadric) to much (a plane).
TEST(Correspondence, SaysItsOwnNoise) {
    std::mt19937 random(3);
    double before = 0;
    for (const double sigma : {0.02, 0.1, 0.3}) {
        std::normal_distribution<double> noise(0, sigma);
        double squares = 0, stated = 0;
        constexpr int kDraws = 4000;
        for (int k = 0; k < kDraws; ++k) {
            const auto local = correspondence_at(
                view_of([&](double x, double y) { return Vector2d(400 + x + noise(random), 300 + y + noise(random)); },
                        sigma),
                kMiddle, kMiddle);
            ASSERT_TRUE(local);
            squares += (local->code - Vector2d(400, 300)).squaredNorm() / 2;
            stated = local->sigma_px;
        }
        EXPECT_NEAR(std::sqrt(squares / kDraws), stated, 0.05 * stated) << sigma;
        EXPECT_GT(stated, before);
        EXPECT_LT(stated, 0.4 * sigma);
        before = stated;
    }
}

/// Light blurred over one pixel (one standard deviation, an axis) that rises by 4 % a pixel shows at every pixel the
/// code of a place 0.04 px nearer to the light: the integral of a Gaussian times 1 + 0.04 x. That is taken back.
TEST(Correspondence, IsTakenBackFromTheLight) {
    constexpr double kRise = 0.04;
    const Map seen = [&](double x, double y) {
        return Vector2d(400 + 1.1 * (x + kRise), 300 + 0.9 * y + 0.1 * (x + kRise));
    };
    const auto dim = [&](double x, double) { return std::exp(-kRise * x); };
    const auto even = correspondence_at(view_of(seen, 0.02), kMiddle, kMiddle),
               lit = correspondence_at(view_of(seen, 0.02, dim), kMiddle, kMiddle);
    ASSERT_TRUE(even && lit);
    EXPECT_NEAR(even->code.x() - 400, 1.1 * kRise, 1e-3);
    EXPECT_NEAR(lit->code.x(), 400, 0.05 * kRise);
    EXPECT_NEAR(lit->code.y(), 300, 0.05 * kRise);
}

/// Where light ends (a sticker, the rim of the projector's picture) it says nothing of a slope: the plane's mean stays.
TEST(Correspondence, IsLeftAloneAtAnEdgeOfTheLight) {
    const Map seen = [](double x, double y) { return Vector2d(400 + 1.1 * x, 300 + 0.9 * y); };
    const auto dim = [](double x, double) { return x > 0 ? 10.0 : 1.0; };
    const auto local = correspondence_at(view_of(seen, 0.02, dim), kMiddle, kMiddle);
    ASSERT_TRUE(local);
    EXPECT_NEAR(local->code.x(), 400, 0.02);  // by the slope alone it would be 0.3 px
}

}  // namespace
}  // namespace planlight
