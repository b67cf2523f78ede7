#include "registration/projector_measurement/fit_wave.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "registration/projector_measurement/usual_cycles.h"
#include "registration/simulation/light_settings.h"
#include "tests/registration/projector_measurement/tile_room.h"

namespace planlight {
namespace {

/// Visits of three frames at irregular moments over 40 s, 60 frames a second; both halves with noise of their own.
PairedTrace seen(const std::function<double(double)>& light, double noise_grey, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> pause(0.9, 1.9);
    std::normal_distribution<double> noise(0, noise_grey);
    PairedTrace trace;
    for (double at = 3; trace.at_s.size() < 84; at += pause(random))
        for (int i = 0; i < 3; ++i) {
            trace.at_s.push_back(std::round(60 * at + i) / 60);
            trace.a.push_back(light(trace.at_s.back()) + noise(random));
            trace.b.push_back(light(trace.at_s.back()) + noise(random));
        }
    return trace;
}

TEST(FitWave, FindsMeanAndVarianceOfWholeCyclesUnderDriftNoiseAndLamps) {
    for (unsigned seed = 1; seed <= 30; ++seed) {
        const auto trace = seen(
            [](double t) {
                return 100 + 0.2 * t + 10 * std::sin(2 * M_PI * 0.83 * t) + 4 * std::cos(2 * M_PI * 1.66 * t + 1) +
                       6 * std::sin(2 * M_PI * 19.9 * t);
            },
            0.5, seed);
        const WaveFit fit = fit_wave(trace, {0.83, 1.66}, {19.9});
        EXPECT_NEAR(fit.variance, (10 * 10 + 4 * 4) / 2.0, 4) << seed;
        EXPECT_LT(std::abs(fit.variance - 58), 5 * fit.variance_sigma) << seed;
        const double middle_s = (trace.at_s.front() + trace.at_s.back()) / 2;
        EXPECT_NEAR(fit.mean, 100 + 0.2 * middle_s, 0.5) << seed;
        EXPECT_LT(fit.left_over.correlation, 0.5) << "only noise is left";
        const auto hz = strongest_hz({trace}, 30, {19.9});
        ASSERT_TRUE(hz);
        EXPECT_NEAR(*hz, 0.83, 0.003);
    }
}

TEST(FitWave, NoiseHasNoVarianceInCommonAndNoFrequency) {
    double sum = 0;
    for (unsigned seed = 1; seed <= 40; ++seed) {
        const auto trace = seen([](double) { return 100; }, 2, seed);
        sum += fit_wave(trace, {0.83, 1.66}, {}).variance / 40;
        EXPECT_FALSE(strongest_hz({trace}, 30, {})) << seed;
    }
    EXPECT_NEAR(sum, 0, 0.3) << "of a noise of 4 grey squared";
}

TEST(FitWave, TheWidestGapIsThePartOfATurnThatNoFrameMet) {
    EXPECT_NEAR(widest_gap({0, 0.1, 0.2, 0.3, 0.4}, 2), 0.2, 1e-9) << "five phases, 0.2 turns apart";
    EXPECT_NEAR(widest_gap({0, 0.5, 1, 1.5}, 2), 1, 1e-9) << "one phase only";
    EXPECT_NEAR(widest_gap({0, 0.25, 1, 1.25}, 1), 0.75, 1e-9);
}

/// Light of an exposure that begins at phase 0 to 1, mean over all.
double variation(const std::function<double(double)>& light_from) {
    constexpr int kPhases = 20000;
    double sum = 0, squares = 0;
    for (int i = 0; i < kPhases; ++i) {
        const double v = light_from((i + 0.5) / kPhases);
        sum += v / kPhases, squares += v * v / kPhases;
    }
    return std::sqrt(std::max(0.0, squares - sum * sum)) / sum;
}

TEST(UsualCycles, NoLightVariesMoreThanOneFlashACycleAndThatReachesTheBound) {
    for (const double turns : {0.1, 0.48, 0.96, 1.0, 1.3, 1.92, 2.5}) {
        const double bound = most_variation(turns / 60, 60);
        const auto flashes = [=](double from) { return std::floor(from + turns) - std::floor(from); };
        EXPECT_NEAR(variation(flashes), bound, 0.01 * bound + 0.01) << turns;
        for (const int k : {1, 2, 3})
            EXPECT_LE(test::wheel_variation(k * turns, {1, 0, 0}), bound + 1e-6) << turns << " " << k;
    }
}

TEST(UsualCycles, TheFormulaOfTheRoomsIsTheSimulatorsWheel) {
    simulation::LightSettings light;
    light.wheel_hz = 120;
    const double simulated = variation([&](double from) {
        const Instant opened = from_seconds(1 + from / 120);
        return simulation::wheel_during(light, opened, opened + std::chrono::milliseconds(5))[1];
    });
    EXPECT_NEAR(test::wheel_variation(0.6, {0, 1, 0}), simulated, 1e-3);
}

TEST(UsualCycles, WhatLooksAlikeIsNamedWithAllThatItMayBe) {
    const auto exactly = usual_cycles_of_projectors(60.05, 0.003), roughly = usual_cycles_of_projectors(60, 0.1);
    EXPECT_EQ(cycles_that_look_like(0.1, 0.002, exactly, 60), std::vector<double>{120.1});
    EXPECT_EQ(cycles_that_look_like(0.1, 0.002, roughly, 60).size(), 6U) << "a refresh of 60.1, 60.05, 60.03 Hz...";
    EXPECT_EQ(cycles_that_stand_still(roughly, 60, 40).size(), 6U);
    EXPECT_TRUE(cycles_that_stand_still(exactly, 60, 40).empty());
    EXPECT_EQ(cycles_that_stand_still(roughly, 25, 40), std::vector<double>{300});
}

}  // namespace
}  // namespace planlight
