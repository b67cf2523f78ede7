#include <gtest/gtest.h>

#include <cmath>

#include "registration/projector_measurement/light_findings.h"
#include "tests/registration/projector_measurement/tile_room.h"

namespace planlight {
namespace {

using test::TileRoomSettings;

CycleResult measured(const TileRoomSettings& room, CycleSettings settings = {}) {
    test::TileRoom devices(room);
    RecordSettings record;
    record.seed = room.seed;
    return measure_cycle(record_cycle(devices.bench(), record), settings);
}

const CycleRun& run_of(const CycleResult& result, const std::string& name) {
    for (const CycleRun& run : result.runs)
        if (run.name == name) return run;
    throw std::runtime_error("no run of " + name);
}

CycleSettings refresh(double hz, double tolerance_hz) {
    CycleSettings settings;
    settings.refresh_hz = hz;
    settings.refresh_tolerance_hz = tolerance_hz;
    return settings;
}

/// 60 frames a second, and a projector a third of a hertz beside them: a beat of seconds.
TEST(CycleRooms, ASlowBeatIsMeasuredOverItsWholeCycle) {
    for (const int turns : {1, 2, 3, 4})
        for (unsigned seed = 1; seed <= 3; ++seed) {
            TileRoomSettings room;
            room.seed = seed;
            room.wheel_hz = turns * 60.31;
            const CycleResult r = measured(room, refresh(60.31, 0.003));
            ASSERT_FALSE(r.refusal);
            EXPECT_TRUE(r.worst_is_told);
            for (const char* colour : {"red", "green", "blue"}) {
                const CycleRun& run = run_of(r, colour);
                const double truth = test::wheel_variation(room.wheel_hz * room.exposure_s, {1, 0, 0});
                EXPECT_NEAR(run.variation, truth, 0.05 * truth + 0.005) << turns << " turns, " << colour;
                EXPECT_LT(run.variation_sigma, 0.1 * truth + 0.005);
                ASSERT_EQ(run.cycles_hz.size(), 1U);
                EXPECT_NEAR(run.cycles_hz.front(), room.wheel_hz, 1e-9);
            }
        }
}

TEST(CycleRooms, WhatIsStatedCoversTheTruthInRoomsOfEveryKind) {
    unsigned sizes = 0, within = 0, bounds = 0, covered = 0, untold = 0;
    for (unsigned seed = 1; seed <= 32; ++seed) {
        std::mt19937 random(seed + 77);
        const auto between = [&](double low, double high) {
            return std::uniform_real_distribution<double>(low, high)(random);
        };
        TileRoomSettings room;
        room.seed = seed;
        room.frames_hz = seed % 2 == 0 ? 60 : 25;
        room.first_frame_s = between(0, 0.1);
        room.wheel_phase = between(0, 1);
        const double refresh_hz = between(59.5, 60.5);
        room.wheel_hz = (1 + seed / 2 % 4) * refresh_hz;
        room.lamps_hz = (seed / 8 % 2 == 0 ? 100 : 120) + between(-0.2, 0.2);
        room.lamps_depth = seed % 3 == 0 ? 0 : between(0.1, 0.4);
        const CycleResult r = measured(room, refresh(refresh_hz, 0.003));
        ASSERT_FALSE(r.refusal) << seed;
        EXPECT_TRUE(r.projector_varies) << seed;
        for (const CycleRun& run : r.runs) {
            if (run.name == "black") continue;
            const double truth = test::wheel_variation(
                room.wheel_hz * room.exposure_s, run.name == "white" ? room.colours : std::array<double, 3>{1, 0, 0});
            ++bounds, covered += truth <= run.at_most;
            if (run.cycles_hz.size() == 1) {
                EXPECT_NEAR(run.cycles_hz.front(), room.wheel_hz, 1) << seed << run.name;
            }
            if (!run.size_is_told) {
                ++untold;
                continue;
            }
            ++sizes, within += std::abs(run.variation - truth) <= 2 * run.variation_sigma;
        }
    }
    EXPECT_GT(sizes, 105U) << "of 128; " << untold << " not told";
    EXPECT_GE(within, 0.93 * sizes);
    EXPECT_GE(covered, 0.95 * bounds);
}

TEST(CycleRooms, ABeatSlowerThanTheRecordingIsNotGivenASize) {
    bool missed = false;
    for (unsigned seed = 1; seed <= 8; ++seed) {
        TileRoomSettings room;
        room.seed = seed;
        room.wheel_phase = seed / 8.0;
        room.wheel_hz = 60.012;  // one beat in 83 s
        const CycleResult r = measured(room);
        ASSERT_FALSE(r.refusal);
        ASSERT_TRUE(r.projector_varies);
        EXPECT_FALSE(r.worst_is_told);
        EXPECT_FALSE(r.cycle_is_told);
        const double truth = test::wheel_variation(room.wheel_hz * room.exposure_s, {1, 0, 0});
        for (const char* colour : {"red", "green", "blue"}) {
            const CycleRun& run = run_of(r, colour);
            EXPECT_FALSE(run.size_is_told) << "also of a colour that was met at its even part";
            EXPECT_GE(run.at_most, truth);
            missed = missed || std::abs(run.variation - truth) > 0.2 * truth;
        }
        EXPECT_NE(meaning_of(r).find("too slowly"), std::string::npos);
        ASSERT_FALSE(findings_of(r).empty());
        EXPECT_NE(findings_of(r).front().what.find("cannot tell"), std::string::npos);
        EXPECT_NEAR(r.exposure_to_set_s, 1 / 60.0, 1e-6) << "the cure is known all the same";
    }
    EXPECT_TRUE(missed) << "what was met is not the size: a size would have been wrong";
}

TEST(CycleRooms, WithoutTheExactRefreshNoOneCycleIsClaimedAtSixtyFrames) {
    TileRoomSettings room;
    room.wheel_hz = 180.15;
    const auto exactly = run_of(measured(room, refresh(60.05, 0.003)), "red").cycles_hz;
    ASSERT_EQ(exactly.size(), 1U);
    EXPECT_NEAR(exactly.front(), 180.15, 1e-9);
    EXPECT_GT(run_of(measured(room), "red").cycles_hz.size(), 1U);
    EXPECT_FALSE(measured(room).cycle_is_told);
}

TEST(CycleRooms, ASteadyProjectorUnderFlickeringLampsStaysSteady) {
    for (unsigned seed = 1; seed <= 12; ++seed) {
        TileRoomSettings room;
        room.seed = seed;
        room.frames_hz = seed % 2 == 0 ? 60 : 25;
        room.lamps_hz = (seed % 3 == 0 ? 100 : 120) + 0.013 * seed;
        room.lamps_depth = 0.4;
        const CycleResult r = measured(room);
        ASSERT_FALSE(r.refusal);
        EXPECT_FALSE(r.projector_varies) << seed;
        // A wheel in step with the frames would look the same.
        EXPECT_NE(meaning_of(r).find("as far as these frames can tell"), std::string::npos);
    }
}

TEST(FrameTiming, JitterOfTheTimeStampsAveragesOutAndPausesAreNotLosses) {
    std::mt19937 random(5);
    std::normal_distribution<double> jitter_s(0, 1e-4);
    LightRecording recording;
    for (int i = 0, n = 0; i < 300; ++i, n += i % 3 == 0 ? 17 : 1) {
        if (i % 3 == 0) recording.orders.push_back({from_seconds((n - 1.5) / 60.0), {}, {}, {0, 0, 0}, false});
        FrameBrightness frame;
        frame.at = from_seconds(n / 60.0 + jitter_s(random));
        frame.number = static_cast<std::uint64_t>(n);
        recording.frames.push_back(frame);
    }
    const FrameTiming timing = frame_timing(recording);
    EXPECT_NEAR(60 * timing.interval_s, 1, 1e-5);
    EXPECT_EQ(timing.lost, 0U);
    EXPECT_EQ(timing.doubled, 0U);
}

}  // namespace
}  // namespace planlight
