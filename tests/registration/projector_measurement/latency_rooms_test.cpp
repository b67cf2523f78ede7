#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "registration/projector_measurement/light_findings.h"
#include "tests/registration/projector_measurement/tile_room.h"

namespace planlight {
namespace {

struct Measured {
    LatencyResult result;
    double mean_s = 0, worst_s = 0;  ///< the truth
};

Measured measured(const test::TileRoomSettings& room) {
    test::TileRoom devices(room);
    RecordSettings record;
    record.seed = room.seed;
    Measured m;
    m.result = measure_latency(record_latency(devices.bench(), record));
    auto truth = devices.true_delays_s();
    truth.pop_back();  // the darkness at the end
    m.mean_s = std::accumulate(truth.begin(), truth.end(), 0.0) / static_cast<double>(truth.size());
    m.worst_s = *std::max_element(truth.begin(), truth.end());
    return m;
}

bool says_in_step(const LatencyResult& result) {
    const auto findings = findings_of(result);
    return std::any_of(findings.begin(), findings.end(),
                       [](const LightFinding& f) { return f.what.find("in step") != std::string::npos; });
}

/// 60 frames a second of 8 ms, a refresh of 60 Hz: no change comes within an exposure, and none narrows the others.
TEST(LatencyRooms, InStepWithTheCamerasTheTimeBetweenExposuresIsClaimedAndTheDelayToSetCoversIt) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
        test::TileRoomSettings room;
        room.seed = seed;
        room.refresh_hz = 60;
        room.refresh_phase = 0.5 + 0.07 * seed;  // 9.5 to 15.8 ms after an exposure's begin
        room.delay_s = 0.02 + 0.003 * seed;
        const Measured m = measured(room);
        ASSERT_FALSE(m.result.refusal) << m.result.refusal->reason;
        EXPECT_EQ(m.result.exact, 0U);
        EXPECT_NEAR(m.result.blind_s, 1 / 60.0 - 0.008, 2e-4);
        EXPECT_GE(m.result.median_sigma_s, m.result.blind_s / std::sqrt(12.0));
        EXPECT_LT(std::abs(m.result.median_s - m.mean_s), m.result.blind_s / 2 + 1e-3);
        EXPECT_GE(m.result.light_delay_s, m.worst_s);
        EXPECT_TRUE(says_in_step(m.result));
    }
}

TEST(LatencyRooms, NearlyInStepTheRefreshesAreFoundAndPlaceTheChangesBetweenExposures) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
        test::TileRoomSettings room;
        room.seed = seed;
        room.refresh_hz = 59.8;
        room.refresh_phase = 0.03 * seed;
        room.delay_s = 0.03 + 0.004 * seed;
        if (seed % 2 == 0) room.jitter_s = 0.008;
        const Measured m = measured(room);
        ASSERT_FALSE(m.result.refusal) << m.result.refusal->reason;
        EXPECT_NEAR(m.result.refresh_hz, 59.8, 0.005) << seed;
        EXPECT_NEAR(1e3 * m.result.median_s, 1e3 * m.mean_s, 1.5) << seed;
        EXPECT_LT(std::abs(m.result.median_s - m.mean_s), 3 * m.result.median_sigma_s) << seed;
        EXPECT_GE(m.result.light_delay_s, m.worst_s);
        EXPECT_LT(m.result.light_delay_s, m.worst_s + 0.012);
        EXPECT_FALSE(says_in_step(m.result));
    }
}

TEST(LatencyRooms, WhereThereIsNoRefreshNoneIsFound) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
        test::TileRoomSettings room;
        room.seed = seed;
        if (seed % 2 == 0) room.jitter_s = 0.012;
        const Measured m = measured(room);
        ASSERT_FALSE(m.result.refusal) << m.result.refusal->reason;
        EXPECT_EQ(m.result.refresh_hz, 0) << seed;
        EXPECT_EQ(m.result.blind_s, 0) << seed;
        EXPECT_LT(std::abs(m.result.median_s - m.mean_s), 3 * m.result.median_sigma_s) << seed;
    }
}

}  // namespace
}  // namespace planlight
