#include <gtest/gtest.h>

#include <cmath>

#include "registration/projector_measurement/light_findings.h"
#include "tests/registration/projector_measurement/light_scene.h"

namespace planlight {
namespace {

using std::chrono::milliseconds;
using test::grey;

CycleResult measured(const test::LightScene& scene, unsigned seed = 1) {
    const auto orders = test::steady_orders({grey(0), grey(255), {255, 0, 0}, grey(0)}, milliseconds(1700));
    return measure_cycle(scene.record(orders, milliseconds(3 * 1700 + 100), seed));
}

std::function<double(double)> wave(double hz, double amplitude) {
    return [=](double t) { return 1 + amplitude * std::sin(2 * M_PI * hz * t + 0.4); };
}

/// What an exposure leaves of a wave's amplitude.
double left_over(double hz, double exposure_s) {
    return std::abs(std::sin(M_PI * hz * exposure_s) / (M_PI * hz * exposure_s));
}

TEST(ColourCycle, SteadyLightIsCalledSteadyWhateverTheNoise) {
    for (unsigned seed = 1; seed <= 40; ++seed) {
        test::LightScene scene;
        scene.noise_grey = 0.02 * seed;
        const CycleResult r = measured(scene, seed);
        ASSERT_FALSE(r.refusal);
        EXPECT_FALSE(r.projector_varies || r.room_varies) << seed;
        EXPECT_EQ(r.exposure_to_set_s, 0);
        EXPECT_TRUE(findings_of(r).empty());
    }
}

TEST(ColourCycle, TheVariationIsThatOfTheLightInTheExposure) {
    test::LightScene scene;
    scene.lamp_at = wave(120, 0.2);
    const CycleResult r = measured(scene);
    const double truth = 0.2 / std::sqrt(2.0) * left_over(120, 0.005);
    ASSERT_EQ(r.runs.size(), 3U);
    EXPECT_TRUE(r.projector_varies);
    EXPECT_NEAR(r.runs[1].variation, truth, 0.05 * truth);
    EXPECT_NEAR(r.runs[2].variation, truth, 0.05 * truth);
    EXPECT_FALSE(r.room_varies);
}

TEST(ColourCycle, RoomAndProjectorAreToldApart) {
    test::LightScene scene;
    scene.interval = std::chrono::microseconds(16400);
    scene.room_at = wave(100, 0.3);
    const CycleResult lamps = measured(scene);
    EXPECT_TRUE(lamps.room_varies);
    EXPECT_FALSE(lamps.projector_varies);
    EXPECT_NEAR(lamps.runs[0].variation, 0.3 / std::sqrt(2.0) * left_over(100, 0.005), 0.01);
    ASSERT_EQ(lamps.runs[0].cycles_hz.size(), 1U);
    EXPECT_EQ(lamps.runs[0].cycles_hz[0], 100);
    EXPECT_TRUE(lamps.cycle_is_told);
    EXPECT_NEAR(lamps.exposure_to_set_s, 0.010, 1e-9);
    scene.lamp_at = wave(180, 0.2);
    const CycleResult both = measured(scene);
    EXPECT_TRUE(both.room_varies && both.projector_varies);
    // 100 and 180 Hz are whole after 50 ms first.
    EXPECT_NEAR(both.exposure_to_set_s, 0.050, 0.001);
}

TEST(ColourCycle, WhatTheFrameRateHidesIsSaid) {
    test::LightScene scene;
    scene.interval = milliseconds(20);  // 50 frames a second: 100, 300 Hz stand still
    scene.room_at = wave(100, 0.3);
    const CycleResult r = measured(scene);
    EXPECT_FALSE(r.room_varies);
    EXPECT_NE(std::find(r.unseen_hz.begin(), r.unseen_hz.end(), 100), r.unseen_hz.end());
    EXPECT_NE(meaning_of(r).find("cannot be seen"), std::string::npos);
    // 60, 240, 360 Hz look the same at 50 frames a second: none is claimed.
    scene.lamp_at = wave(240, 0.3);
    const CycleResult wheel = measured(scene);
    EXPECT_TRUE(wheel.projector_varies);
    EXPECT_GT(wheel.runs[1].cycles_hz.size(), 1U);
    EXPECT_FALSE(wheel.cycle_is_told);
    EXPECT_NEAR(wheel.exposure_to_set_s, 1 / 60.0, 1e-9);  // whole cycles of each of them
}

TEST(ColourCycle, AnExposureOfWholeCyclesIsTheCure) {
    test::LightScene scene;
    scene.lamp_at = wave(120, 0.3);
    const double cure_s = measured(scene).exposure_to_set_s;
    ASSERT_GT(cure_s, 0);
    scene.exposure = from_seconds(cure_s);
    EXPECT_FALSE(measured(scene).projector_varies);
}

TEST(ColourCycle, TooFewFramesAndNoBlackAreRefused) {
    const auto orders = test::steady_orders({grey(0), grey(255), grey(0)}, milliseconds(400));
    const CycleResult few = measure_cycle(test::LightScene{}.record(orders, milliseconds(1000)));
    ASSERT_TRUE(few.refusal);
    EXPECT_NE(few.refusal->reason.find("24 frames"), std::string::npos);
    const auto no_black = test::steady_orders({grey(255), grey(255)}, milliseconds(1700));
    const CycleResult bright = measure_cycle(test::LightScene{}.record(no_black, milliseconds(3000)));
    ASSERT_TRUE(bright.refusal);
    EXPECT_NE(bright.refusal->reason.find("black"), std::string::npos);
}

}  // namespace
}  // namespace planlight
