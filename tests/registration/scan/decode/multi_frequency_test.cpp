#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "planning_io/types/error.h"
#include "tests/registration/scan/stripe_room.h"

// Fringes of several frequencies instead of a Gray code.
namespace planlight {
namespace {

using namespace stripe_room;

const Eigen::Vector3d kCentre(120, -40, 360);

struct Codes {
    std::size_t lit = 0, decoded = 0, wrong = 0,
                unlit = 0;  ///< wrong: by a quarter of a fringe or more; unlit: where nothing is lit
};

Codes codes_of(const DecodedView& view, const Truth& truth) {
    Codes codes;
    for (std::size_t i = 0; i < truth.code.size(); ++i) {
        codes.lit += !std::isnan(truth.code[i].x());
        if (std::isnan(view.column[i])) continue;
        ++codes.decoded;
        codes.unlit += std::isnan(truth.code[i].x());
        codes.wrong += std::abs(view.column[i] - truth.code[i].x()) >= 4;
    }
    return codes;
}

TEST(MultiFrequency, HasItsPictures) {
    EXPECT_EQ(stripe_sequence(multi_frequency_stripes(800, 600)).size(), 38u);
    EXPECT_EQ(stripe_sequence(multi_frequency_stripes(800, 600, false)).size(), 20u);
    EXPECT_EQ(stripe_sequence(multi_frequency_stripes(1920, 1080)).size(), 48u);
    EXPECT_EQ(stripe_sequence(multi_frequency_stripes(1920, 1080, false)).size(), 25u);
}

TEST(MultiFrequency, PeriodsThatConfuseTwoFringesAreRefused) {
    StripeSettings stripes = multi_frequency_stripes(800, 600);
    stripes.order_periods_px = {20, 32};  // of 16, 20 and 32 pixels 160 is a common multiple
    EXPECT_THROW(stripe_sequence(stripes), std::invalid_argument);
    stripes.order_periods_px = {2, 18};
    EXPECT_THROW(stripe_sequence(stripes), std::invalid_argument);
}

/// The dimmer the light and the stronger the noise, the more is dropped; what is decoded stays right.
TEST(MultiFrequency, AnUncertainOrderIsDroppedAndNeverGuessed) {
    for (const auto& [white_grey, noise_grey, least_decoded] :
         {std::array{190.0, 1.5, 0.98}, {60.0, 1.5, 0.9}, {60.0, 3.0, 0.7}, {40.0, 5.0, 0.0}}) {
        Room room = paper_room(sphere(kCentre, 80));
        room.light.white_grey = white_grey;
        room.light.noise_grey = noise_grey;
        const StripeSettings stripes = multi_frequency_stripes(800, 600);
        const Codes codes =
            codes_of(decode_stripes(photograph(room, room.left, stripes, 5), stripes), truth_of(room, room.left));
        fmt::print("white {} grey, noise {}: {} of {} decoded, {} wrong, {} unlit\n", white_grey, noise_grey,
                   codes.decoded, codes.lit, codes.wrong, codes.unlit);
        EXPECT_GT(static_cast<double>(codes.decoded), least_decoded * static_cast<double>(codes.lit));
        EXPECT_LT(static_cast<double>(codes.wrong), 1e-4 * static_cast<double>(codes.lit));
        // The silhouette, where blur carries light to pixels that see past the ball, is half a percent of the pixels.
        EXPECT_LT(static_cast<double>(codes.unlit), 0.007 * static_cast<double>(codes.lit));
    }
}

/// Three shifts of every frequency under a gamma of 2.2.
TEST(MultiFrequency, ThreeShiftsUnderAGammaAreReadAsWell) {
    const Room room = paper_room(sphere(kCentre, 80));
    StripeSettings stripes = multi_frequency_stripes(800, 600);
    stripes.phase_steps = stripes.order_steps = 3;
    const auto frames = photograph(room, room.left, stripes, 5);
    EXPECT_TRUE(check_sequence(frames, stripes).problems.empty());
    const Codes codes = codes_of(decode_stripes(frames, stripes), truth_of(room, room.left));
    EXPECT_GT(static_cast<double>(codes.decoded), 0.85 * static_cast<double>(codes.lit));
    EXPECT_LT(static_cast<double>(codes.wrong), 1e-3 * static_cast<double>(codes.lit));
}

TEST(MultiFrequency, OnAPlaneNoOrderIsWrong) {
    Room room = modern_room(plane(Eigen::Vector3d(120, -40, 300), Eigen::Vector3d(0.35, 0.2, -1).normalized()));
    room.light.white_grey = 60;
    room.light.noise_grey = 3;
    const StripeSettings stripes = multi_frequency_stripes(1920, 1080);
    const Truth truth = truth_of(room, room.left);
    const Codes codes = codes_of(decode_stripes(photograph(room, room.left, stripes, 6), stripes), truth);
    fmt::print("{} of {} decoded, {} wrong\n", codes.decoded, codes.lit, codes.wrong);
    EXPECT_GT(static_cast<double>(codes.decoded), 0.9 * static_cast<double>(codes.lit));
    EXPECT_LT(static_cast<double>(codes.wrong), 1e-4 * static_cast<double>(codes.decoded));
}

TEST(MultiFrequency, ABallIsScannedAsTrulyAsByAGrayCode) {
    for (const bool rows : {true, false}) {
        const Room room = paper_room(sphere(kCentre, 80));
        const ScanResult scan = scan_from_capture(capture(room, multi_frequency_stripes(800, 600, rows)), rig_of(room));
        double squares = 0;
        for (const auto& p : scan.raw.cloud.points_in_rig) squares += std::pow((p - kCentre).norm() - 80, 2);
        const double rms = std::sqrt(squares / static_cast<double>(scan.raw.cloud.size()));
        fmt::print("{}: {} points, rms {:.4f} mm\n", rows ? "both directions" : "columns only", scan.raw.cloud.size(),
                   rms);
        EXPECT_GT(scan.raw.cloud.size(), 30000u);
        EXPECT_LT(rms, 0.05);
    }
}

/// Each camera pixel sees the projector pixel of its own number.
std::vector<GrayImage> seen_one_to_one(const StripeSettings& stripes, int height, double noise_grey) {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, noise_grey);
    std::vector<GrayImage> frames;
    for (const StripePattern& pattern : stripe_sequence(stripes)) {
        const RgbImage picture = draw_stripes(stripes, pattern);
        GrayImage frame(stripes.width, height);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < stripes.width; ++x)
                frame.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(stripes.width) +
                             static_cast<std::size_t>(x)] =
                    static_cast<std::uint8_t>(
                        std::clamp(std::lround(20 + 0.6 * picture.at(x, 0)[0] + noise(random)), 0l, 255l));
        frames.push_back(std::move(frame));
    }
    return frames;
}

/// Where all periods divide the projector's width, the phases of a place beyond one rim are those at the other: no
/// place for light to come from, and no rival. Only what noise could put across the rim stays open.
TEST(MultiFrequency, WholePeriodsOverThePictureLoseNoRim) {
    for (const auto& [width, period, others] :
         {std::tuple{1024, 16.0, std::vector{1024.0 / 63, 1024.0 / 56}}, {1024, 32.0, std::vector{1024.0, 128.0}}}) {
        StripeSettings stripes;
        stripes.width = width;
        stripes.height = 16;
        stripes.rows = stripes.inverse = false;
        stripes.phase_period_px = period;
        stripes.order_periods_px = others;
        const DecodedView view = decode_stripes(seen_one_to_one(stripes, 32, 1.5), stripes);
        std::size_t lost = 0;
        for (std::size_t i = 0; i < view.column.size(); ++i) {
            const double x = static_cast<double>(i % static_cast<std::size_t>(width));
            const bool rim = x < 2 || x > width - 3;
            lost += std::isnan(view.column[i]) && !rim;
            if (std::isnan(view.column[i])) continue;
            EXPECT_NEAR(view.column[i], x, 1);
        }
        EXPECT_LT(static_cast<double>(lost), 1e-3 * static_cast<double>(view.column.size())) << period;
    }
}

/// Frames without noise, as shown and spoilt.
struct Shot {
    StripeSettings stripes;
    std::vector<GrayImage> frames;
};

const Shot& shot() {
    static const Shot s = [] {
        Room room = paper_room(sphere(kCentre, 80));
        const StripeSettings stripes = multi_frequency_stripes(800, 600);
        return Shot{stripes, photograph(room, room.left, stripes, 1)};
    }();
    return s;
}

TEST(MultiFrequency, CleanSequencesAreNotRefused) {
    for (const bool rows : {true, false})
        for (const double noise_grey : {0.5, 1.5, 3.0})
            for (const double white_grey : {190.0, 90.0}) {
                Room room = paper_room(sphere(kCentre, 80));
                room.light.noise_grey = noise_grey;
                room.light.white_grey = white_grey;
                const StripeSettings stripes = multi_frequency_stripes(800, 600, rows);
                const SequenceCheck check = check_sequence(photograph(room, room.right, stripes, 2), stripes);
                EXPECT_TRUE(check.checked);
                EXPECT_TRUE(check.problems.empty()) << noise_grey << " " << white_grey << ": "
                                                    << (check.problems.empty() ? "" : check.problems[0].what);
            }
}

/// Late, doubled, missing and swapped frames, wherever it happens.
TEST(MultiFrequency, FaultsOfTheSequenceAreNoticed) {
    const std::vector<GrayImage>& good = shot().frames;
    const std::size_t n = good.size();
    std::size_t noticed = 0, all = 0;
    std::string missed;
    for (std::size_t m = 1; m < n; ++m)
        for (int fault = 0; fault < 5; ++fault) {
            std::vector<GrayImage> frames = good;
            if (fault == 0) frames[m] = good[m - 1];
            for (std::size_t i = m; i < n && fault == 1; ++i) frames[i] = good[i - 1];
            for (std::size_t i = m; i < n && fault == 2; ++i) frames[i] = good[std::min(i + 1, n - 1)];
            if (fault == 3) std::swap(frames[m], frames[m + 1 < n ? m + 1 : m - 1]);
            if (fault == 4) std::swap(frames[m], frames[(m * 17 + 5) % n == m ? m - 1 : (m * 17 + 5) % n]);
            ++all;
            const bool seen = !check_sequence(frames, shot().stripes).problems.empty();
            noticed += seen;
            if (!seen) missed += fmt::format(" {}:{}", fault, stripe_sequence(shot().stripes)[m].name);
        }
    fmt::print("{} of {} faults noticed; missed:{}\n", noticed, all, missed);
    EXPECT_EQ(noticed + 1, all)
        << missed;  // where the last frame is the missing one, nothing follows and nothing is wrong
}

TEST(MultiFrequency, WholeFrequenciesSwappedAreNoticed) {
    std::vector<GrayImage> frames = shot().frames;
    for (std::size_t k = 0; k < 5; ++k) std::swap(frames[10 + k], frames[15 + k]);  // of the columns
    EXPECT_FALSE(check_sequence(frames, shot().stripes).problems.empty());
}

}  // namespace
}  // namespace planlight
