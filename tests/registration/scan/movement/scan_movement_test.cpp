#include "registration/scan/movement/scan_movement.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "registration/scan/check/camera_gamma.h"
#include "registration/scan/movement/affine_movement.h"
#include "registration/scan/movement/uniform_light_frames.h"
#include "tests/registration/gray_columns.h"

namespace planlight {
namespace {

constexpr int kWidth = 320, kHeight = 240, kBits = 6;

/// Skin with patches of a few pixels to a few tens, as it looks when moved by (dx, dy) pixels.
double skin(double x, double y) {
    return 120 + 18 * std::sin(0.31 * x + 0.2 * y) + 14 * std::sin(0.23 * y - 0.11 * x + 1) +
           10 * std::sin(0.9 * x) * std::sin(0.8 * y);
}

/// A Gray code of columns whose patient is at `at(share)` (pixels) when a share of the pictures is taken.
ScanCapture capture_of(const std::function<Eigen::Vector2d(double)>& at, double gain_at_the_end = 1) {
    ScanCapture capture;
    capture.stripes.width = kWidth;
    capture.stripes.height = kHeight;
    capture.stripes.rows = false;
    capture.partial = test::gray_columns(kBits);
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 1.5);
    for (std::size_t k = 0; k < capture.partial.size(); ++k) {
        const double share = static_cast<double>(k) / static_cast<double>(capture.partial.size() - 1);
        const Eigen::Vector2d d = at(share);
        const double gain = 1 + (gain_at_the_end - 1) * share;
        GrayImage frame(kWidth, kHeight);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const auto kind = capture.partial[k].kind;
                bool lit = kind == StripePattern::Kind::white;
                if (k >= 2)
                    lit =
                        ((x >> (kBits - capture.partial[k].index)) % 2 == 0) == (kind == StripePattern::Kind::gray_bit);
                const bool head = std::hypot(x - kWidth / 2.0 - d.x(), y - kHeight / 2.0 - d.y()) < 100;
                const double light = head ? skin(x - d.x(), y - d.y()) * ((lit ? gain : 0) + 0.12) : 3;
                frame.at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(light + noise(random)), 0L, 255L));
            }
        capture.left.push_back(std::move(frame));
    }
    return capture;
}

/// The same with the edges of the stripes blurred over three pixels, by a camera that gives light to the power 1 /
/// `gamma`.
ScanCapture encoded_capture(double gamma, const Eigen::Vector2d& way_px) {
    ScanCapture capture = capture_of([](double) { return Eigen::Vector2d(0, 0); });
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, 0.7);
    for (std::size_t k = 0; k < capture.partial.size(); ++k) {
        const auto& pattern = capture.partial[k];
        const Eigen::Vector2d d = way_px * static_cast<double>(k) / static_cast<double>(capture.partial.size() - 1);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                double lit = pattern.kind == StripePattern::Kind::white ? 1 : 0;
                for (int i = -1; k >= 2 && i <= 1; ++i)
                    lit += (((x + i) >> (kBits - pattern.index)) % 2 == 0) ==
                                   (pattern.kind == StripePattern::Kind::gray_bit)
                               ? 1.0 / 3
                               : 0.0;
                const bool head = std::hypot(x - kWidth / 2.0 - d.x(), y - kHeight / 2.0 - d.y()) < 100;
                const double light = head ? skin(x - d.x(), y - d.y()) * (lit + 0.12) : 3;
                const double grey = 255 * std::pow(light / 255, 1 / gamma) + noise(random);
                capture.left[k].at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
            }
    }
    return capture;
}

ScanMovement seen(const ScanCapture& capture) {
    return movement_in_pictures(capture, 0.42);
}

TEST(ScanMovement, APatientAtRestMovesByTheNoiseOnly) {
    const ScanMovement movement = seen(capture_of([](double) { return Eigen::Vector2d(0, 0); }));
    EXPECT_EQ(movement.by, ScanMovement::By::pictures);
    EXPECT_EQ(movement.moments, 1 + kBits);
    EXPECT_LT(movement.moved_mm, 0.02);
    EXPECT_LT(movement.light_change, 0.01);
}

// Where a stripe's edge halves the light, such a camera shows more than half: stripes are left in the sum of a bit and
// its inverse. They are no movement.
TEST(ScanMovement, ACameraThatEncodesForAScreenIsUnderstood) {
    for (const double gamma : {1.0, 1.8, 2.2}) {
        const ScanCapture still = encoded_capture(gamma, {0, 0});
        EXPECT_NEAR(camera_gamma(still.left, uniform_light_frames(still)), gamma, 0.12);
        EXPECT_LT(seen(still).moved_mm, 0.03) << gamma;
        const Eigen::Vector2d way_px(0.4, -0.3);
        EXPECT_NEAR(seen(encoded_capture(gamma, way_px)).moved_mm, 0.42 * 0.5 * 12 / 13, 0.03) << gamma;
    }
}

TEST(ScanMovement, AShiftAcrossThePictureIsMeasured) {
    for (const double way_px : {0.25, 0.5, 1.0}) {
        const ScanMovement movement = seen(
            capture_of([&](double share) -> Eigen::Vector2d { return way_px * share * Eigen::Vector2d(0.8, -0.6); }));
        // The first and the last moment are half a pair of pictures inside the sequence: 12 of 13 steps.
        EXPECT_NEAR(movement.moved_mm, 0.42 * way_px * 12 / 13, 0.02 + 0.05 * way_px) << way_px;
        EXPECT_EQ(movement.from, "white");
        EXPECT_EQ(movement.to, "column-gray-5");
    }
}

// What comes nearer along the left camera's line of sight stays where it is in its picture, and moves aside in the
// right camera's.
TEST(ScanMovement, WhatOneCameraCannotSeeTheOtherDoes) {
    ScanCapture capture = capture_of([](double) { return Eigen::Vector2d(0, 0); });
    capture.right = capture_of([](double share) { return Eigen::Vector2d(share, 0); }).left;
    EXPECT_LT(movement_in_pictures(capture, 0.42).moved_mm, 0.02) << "the left camera alone";
    for (const bool exchanged : {false, true}) {
        if (exchanged) std::swap(capture.left, capture.right);
        const ScanMovement movement = movement_in_pictures(capture, 0.42, 0.42);
        EXPECT_EQ(movement.by, ScanMovement::By::pictures);
        EXPECT_NEAR(movement.moved_mm, 0.42 * 12 / 13, 0.07) << exchanged;
    }
}

TEST(ScanMovement, ACameraThatSeesNothingLeavesItToTheOther) {
    ScanCapture capture = capture_of([](double) { return Eigen::Vector2d(0, 0); });
    capture.right = capture_of([](double share) { return Eigen::Vector2d(share, 0); }).left;
    for (GrayImage& frame : capture.left) frame = GrayImage(kWidth, kHeight, 3);
    EXPECT_GT(movement_in_pictures(capture, 0.42, 0.42).moved_mm, 0.3);
    std::swap(capture.left, capture.right);
    EXPECT_GT(movement_in_pictures(capture, 0.42, 0.42).moved_mm, 0.3);
}

TEST(ScanMovement, AMovementBackAndForthIsNotMissed) {
    const ScanMovement movement =
        seen(capture_of([](double share) { return Eigen::Vector2d(std::sin(M_PI * share), 0); }));
    EXPECT_GT(movement.moved_mm, 0.3) << "first and last picture are alike";
}

TEST(ScanMovement, ALampThatFadesIsNoMovement) {
    const ScanMovement movement = seen(capture_of([](double) { return Eigen::Vector2d(0, 0); }, 0.9));
    EXPECT_LT(movement.moved_mm, 0.03);
    EXPECT_NEAR(movement.light_change, 0.1, 0.02) << "and is told";
}

/// The projector and a lamp from the side as bright as they happen to be, each frame anew by 5 % (one standard
/// deviation) of its own.
ScanCapture flickering(const std::function<Eigen::Vector2d(double)>& at, double projector, double lamp) {
    ScanCapture capture = capture_of(at);
    std::mt19937 random(11);
    std::normal_distribution<double> noise(0, 1.5), by(0, 0.05);
    for (std::size_t k = 0; k < capture.partial.size(); ++k) {
        const StripePattern& pattern = capture.partial[k];
        const Eigen::Vector2d d = at(static_cast<double>(k) / static_cast<double>(capture.partial.size() - 1));
        const double projected = projector * (1 + by(random)), from_aside = lamp * (1 + by(random));
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const bool even = (x >> (kBits - pattern.index)) % 2 == 0;
                const bool lit = k >= 2 ? even == (pattern.kind == StripePattern::Kind::gray_bit) : k == 0;
                const double u = x - d.x(), v = y - d.y();
                const bool head = std::hypot(u - kWidth / 2.0, v - kHeight / 2.0) < 100;
                const double light = head ? skin(u, v) * ((lit ? projected : 0) + from_aside * (0.5 + u / kWidth)) : 3;
                capture.left[k].at(x, y) =
                    static_cast<std::uint8_t>(std::clamp(std::lround(light + noise(random)), 0L, 255L));
            }
    }
    return capture;
}

/// Fringes of a projector that gives light to the power `gamma`.
ScanCapture fringes_of(double gamma, double lamp_in_the_middle = 0) {
    ScanCapture capture;
    capture.stripes.width = kWidth;
    capture.stripes.height = kHeight;
    capture.stripes.rows = false;
    capture.stripes.order_periods_px = {17, 19};
    capture.partial = stripe_sequence(capture.stripes);
    std::mt19937 random(13);
    std::normal_distribution<double> noise(0, 1.5);
    for (std::size_t k = 0; k < capture.partial.size(); ++k) {
        const StripePattern& pattern = capture.partial[k];
        const RgbImage light = draw_stripes(capture.stripes, pattern);
        const double lamp = pattern.frequency == 1 ? lamp_in_the_middle : 0;
        GrayImage frame(kWidth, kHeight);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const double grey = light.at(x, y)[1] / 255.;
                const bool head = std::hypot(x - kWidth / 2.0, y - kHeight / 2.0) < 100;
                const double seen = head ? skin(x, y) * (std::pow(grey, gamma) + 0.12 + lamp) : 3;
                frame.at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(seen + noise(random)), 0L, 255L));
            }
        capture.left.push_back(std::move(frame));
    }
    return capture;
}

// Fringes of a projector with gamma 2.2 are 0.36 of white in the mean, and not a half: nothing has changed.
TEST(ScanMovement, AProjectorsGammaIsNoChangeOfTheLight) {
    for (const double gamma : {1.0, 2.2, 3.0}) {
        const ScanMovement movement = seen(fringes_of(gamma));
        EXPECT_EQ(movement.by, ScanMovement::By::pictures) << gamma;
        EXPECT_GE(movement.moments, 4) << gamma;
        EXPECT_LT(movement.moved_mm, 0.03) << gamma;
        EXPECT_LT(movement.light_change, 0.02) << gamma;
    }
    EXPECT_GT(seen(fringes_of(2.2, 0.2)).light_change, 0.1) << "a lamp that went on meanwhile still is one";
}

TEST(ScanMovement, LampsThatFlickerFromPictureToPictureAreNoMovement) {
    const auto still = [](double) { return Eigen::Vector2d(0, 0); };
    const auto moving = [](double share) { return Eigen::Vector2d(share, 0); };
    for (const auto& [projector, lamp] : {std::pair(1.0, 0.1), std::pair(0.6, 0.5)}) {
        const ScanMovement movement = seen(flickering(still, projector, lamp));
        EXPECT_LT(movement.moved_mm, 0.03) << projector << ", " << lamp;
        EXPECT_GT(movement.light_change, 0.05) << projector << ", " << lamp;
        EXPECT_NEAR(seen(flickering(moving, projector, lamp)).moved_mm, 0.42 * 12 / 13, 0.08)
            << projector << ", " << lamp;
    }
}

TEST(ScanMovement, IsNotKnownWithoutLight) {
    ScanCapture dark = capture_of([](double) { return Eigen::Vector2d(0, 0); });
    for (GrayImage& frame : dark.left) frame = GrayImage(kWidth, kHeight, 3);
    EXPECT_EQ(seen(dark).by, ScanMovement::By::nothing);
}

ScanCapture without_inverses(ScanCapture capture) {
    for (std::size_t k = capture.partial.size(); k-- > 0;)
        if (capture.partial[k].kind == StripePattern::Kind::gray_bit_inverse) {
            capture.partial.erase(capture.partial.begin() + static_cast<std::ptrdiff_t>(k));
            capture.left.erase(capture.left.begin() + static_cast<std::ptrdiff_t>(k));
        }
    return capture;
}

// What is lit in a coarse bit shows the same skin as white does.
TEST(ScanMovement, OfACodeWithoutInversesIsMeasuredWhereItsBitsAreLit) {
    const ScanMovement still = seen(without_inverses(capture_of([](double) { return Eigen::Vector2d(0, 0); })));
    EXPECT_EQ(still.by, ScanMovement::By::pictures);
    EXPECT_GE(still.moments, 4);
    EXPECT_LT(still.moved_mm, 0.03);
    const ScanMovement moved = seen(without_inverses(
        capture_of([](double share) -> Eigen::Vector2d { return share * Eigen::Vector2d(0.8, -0.6); })));
    EXPECT_GT(moved.moved_mm, 0.2) << "of 0.42 mm; the last bits are too fine to be looked at";
    EXPECT_LT(moved.moved_mm, 0.45);
}

// A coarse bit lights a half of the skin; what its map says of the other half is guessed. Dim skin at rest had moved by
// 0.4 mm by two such bits.
TEST(ScanMovement, TwoBitsAreComparedWhereBothAreLit) {
    using namespace affine_movement;
    std::vector<GrayImage> frames(4, GrayImage(kWidth, kHeight));  // white, black, lit above, lit below
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const auto white = static_cast<std::uint8_t>(skin(x, y)), black = std::uint8_t{10};
            const bool above = y < kHeight / 2;
            const std::array grey{white, black, above ? white : black, above ? black : white};
            for (std::size_t k = 0; k < 4; ++k) frames[k].at(x, y) = grey[k];
        }
    Pictures pictures{frames, 0, 1, {}};
    for (std::size_t g = 0; g < pictures.light.size(); ++g) pictures.light[g] = static_cast<float>(g);
    const Moment white{{0}, true, 4}, lit_above{{2}, true, 4}, lit_below{{3}, true, 4};
    const Surface surface(pictures, white, {white, lit_above, lit_below});
    const Laid all = surface.lay(white), below = surface.lay(lit_below);
    Laid above = surface.lay(lit_above);
    ASSERT_TRUE(all.determined && above.determined && below.determined);
    EXPECT_FALSE(surface.between(above, below)) << "no skin that both saw";
    // Moves by (1 + v) pixels: v runs from below 0 at the top, to above 0 at the bottom.
    above.map = all.map + Affine{{1, 0, 1, 0, 0, 0}};
    ASSERT_TRUE(surface.between(all, above));
    EXPECT_LT(surface.between(all, above)->px, 1);
    above.seen.clear();
    EXPECT_GT(surface.between(all, above)->px, 1.5);
}

/// A wall without a spot, brighter than the camera can show in its middle, with a glint: `at` pixels of the camera's
/// own noise.
ScanCapture blown_out(double top_grey) {
    ScanCapture capture = capture_of([](double) { return Eigen::Vector2d(0, 0); });
    std::mt19937 random(11);
    std::normal_distribution<double> noise(0, 2);
    for (std::size_t k = 0; k < capture.partial.size(); ++k) {
        const auto& pattern = capture.partial[k];
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                double lit = pattern.kind == StripePattern::Kind::white ? 1 : 0;
                if (k >= 2)
                    lit = ((x >> (kBits - pattern.index)) % 2 == 0) == (pattern.kind == StripePattern::Kind::gray_bit);
                const double u = (x - 150) / 200.0, v = (y - 100) / 200.0,
                             glint = std::exp(-((x - 210) * (x - 210) + (y - 60) * (y - 60)) / 200.0);
                const double light = 9 + lit * (top_grey * (1 - 0.5 * (u * u + v * v)) + 300 * glint);
                capture.left[k].at(x, y) =
                    static_cast<std::uint8_t>(std::clamp(std::lround(light + noise(random)), 0L, 255L));
            }
    }
    return capture;
}

// A still wall, clipped by the camera: where noise decides whether a pixel is clipped, those that are not are too dark
// by chance, and on a smooth slope of light that looks like a way of millimetres.
TEST(ScanMovement, ASaturatedWallAtRestHasNotMoved) {
    for (const double top_grey : {200.0, 235.0, 250.0, 280.0, 330.0}) {
        const ScanMovement movement = seen(blown_out(top_grey));
        EXPECT_LT(movement.way_mm(), 0.1) << top_grey << ": 0.15 is the limit";
        if (movement.by == ScanMovement::By::pictures) {
            EXPECT_GT(movement.unseen_mm(), 0.05) << top_grey << ": it could move unseen, and that is said";
        }
    }
}

TEST(ScanMovement, EvenPicturesHoldNoStripes) {
    const ScanCapture capture = capture_of([](double) { return Eigen::Vector2d(0, 0); });
    const auto moments = uniform_light_frames(capture);
    const auto first = sum_uniform_light(capture.left, moments[0]);
    for (std::size_t m = 1; m < moments.size(); ++m) {
        const auto later = sum_uniform_light(capture.left, moments[m]);
        double squares = 0;
        for (std::size_t i = 0; i < first.size(); ++i) squares += std::pow(static_cast<double>(first[i] - later[i]), 2);
        EXPECT_LT(std::sqrt(squares / static_cast<double>(first.size())), 3.5) << "four times the noise of 1.53";
    }
}

}  // namespace
}  // namespace planlight
