#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "registration/projector_measurement/fit_delays.h"
#include "registration/projector_measurement/light_findings.h"
#include "registration/projector_measurement/record_light.h"
#include "tests/registration/projector_measurement/card_room.h"
#include "tests/registration/projector_measurement/light_scene.h"

namespace planlight {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

LightRecording flashed(const test::LightScene& scene, Instant bit = milliseconds(60)) {
    const auto orders = test::flashes(flash_code(), bit);
    return scene.record(orders, orders.back().at + milliseconds(900));
}

bool says(const LatencyResult& result, const std::string& word) {
    const auto findings = findings_of(result);
    return std::any_of(findings.begin(), findings.end(),
                       [&](const auto& f) { return f.what.find(word) != std::string::npos; });
}

TEST(FlashCode, NoWindowOfSixBitsComesTwice) {
    const auto code = flash_code();
    ASSERT_EQ(code.size(), 63U);
    std::set<unsigned> windows;
    for (std::size_t i = 0; i < 63; ++i) {
        unsigned window = 0;
        for (std::size_t k = 0; k < 6; ++k) window = 2 * window + code[(i + k) % 63];
        windows.insert(window);
    }
    EXPECT_EQ(windows.size(), 63U);
}

TEST(Latency, IsFoundToAFractionOfAnExposureAndNeverOffByAFrameOrAFlash) {
    for (const int delay_us : {3100, 17000, 25000, 58000, 61000, 122300, 250000, 480000}) {
        test::LightScene scene;
        scene.delay = microseconds(delay_us);
        const LatencyResult r = measure_latency(flashed(scene));
        ASSERT_FALSE(r.refusal) << delay_us << ": " << r.refusal->reason;
        EXPECT_NEAR(1e3 * r.median_s, delay_us / 1e3, 0.3) << delay_us;
        EXPECT_GE(r.light_delay_s, delay_us / 1e6);
        EXPECT_LT(r.light_delay_s, delay_us / 1e6 + 0.006);
        EXPECT_EQ(r.unseen, 0U);
        EXPECT_GT(r.exact, 4U);
    }
}

TEST(Latency, WithoutAChangeWithinAnExposureOnlyTheTimeBetweenExposuresIsClaimed) {
    test::LightScene scene;
    scene.exposure = microseconds(50);  // hardly ever open
    for (int delay_us = 38000; delay_us <= 42000; delay_us += 250) {
        scene.delay = microseconds(delay_us);
        const LatencyResult r = measure_latency(flashed(scene));
        ASSERT_FALSE(r.refusal);
        const double off_s = std::abs(r.median_s - 1e-6 * delay_us);
        EXPECT_LT(off_s, 4e-3) << delay_us;
        EXPECT_LT(off_s, 2 * r.median_sigma_s) << delay_us << ": even over the bounds, none is farther off";
        if (r.exact > 0) continue;
        const double shared_s = r.earliest_s - r.latest_s;
        EXPECT_GT(shared_s, 0) << delay_us;
        EXPECT_GE(r.median_sigma_s, 0.999 * shared_s / std::sqrt(12.0)) << delay_us;
    }
}

TEST(Latency, ABrokenPromiseIsSaidWithTheDelayToSet) {
    test::LightScene scene;
    auto recording = flashed(scene);
    const auto promise = [&](Instant delay) {
        for (LightOrder& order : recording.orders) order.returned = order.at, order.promised = order.at + delay;
        return measure_latency(recording);
    };
    const LatencyResult early = promise(milliseconds(25));
    ASSERT_TRUE(early.promise);
    EXPECT_EQ(early.promise->broken, 0U + std::count_if(early.delays.begin(), early.delays.end(),
                                                        [](const auto& d) { return d.at_least_s > 0.0255; }));
    EXPECT_NEAR(1e3 * early.promise->too_early_s, 15, 0.5);
    EXPECT_TRUE(says(early, "too early"));
    EXPECT_FALSE(says(promise(milliseconds(44)), "promised"));
    EXPECT_TRUE(says(promise(milliseconds(80)), "too long"));
}

TEST(Latency, AClockThatIsAheadIsRefusedNotMeasured) {
    test::LightScene scene;
    auto recording = flashed(scene);
    for (auto& frame : recording.frames) frame.at -= milliseconds(120);
    const LatencyResult r = measure_latency(recording);
    ASSERT_TRUE(r.refusal);
    EXPECT_NE(r.refusal->reason.find("before it was ordered"), std::string::npos);
}

TEST(Latency, WhatRepeatsOrDoesNotFitOrIsTooFastIsRefused) {
    test::LightScene scene;
    std::vector<bool> regular;
    for (int i = 0; i < 63; ++i) regular.push_back(i % 2 == 0);
    auto orders = test::flashes(regular, milliseconds(60));
    for (std::size_t i = 3; i < orders.size(); ++i)
        orders[i].at = milliseconds(1800) + static_cast<int>(i - 3) * milliseconds(60);
    const LatencyResult repeats = measure_latency(scene.record(orders, orders.back().at + milliseconds(900)));
    ASSERT_TRUE(repeats.refusal);
    EXPECT_NE(repeats.refusal->reason.find("repeat"), std::string::npos);

    auto recording = flashed(scene);
    std::mt19937 random(3);
    for (LightOrder& order : recording.orders)
        if (order.at > milliseconds(1700)) order.at = milliseconds(1800) + milliseconds(random() % 3800);
    std::sort(recording.orders.begin(), recording.orders.end(),
              [](const auto& a, const auto& b) { return a.at < b.at; });
    EXPECT_TRUE(measure_latency(recording).refusal);

    const LatencyResult slow = measure_latency(flashed(scene, milliseconds(25)));
    ASSERT_TRUE(slow.refusal);
    EXPECT_NE(slow.refusal->reason.find("too slow"), std::string::npos);

    test::LightScene dark;
    dark.white_grey = dark.room_grey + 1;
    EXPECT_TRUE(measure_latency(flashed(dark)).refusal);
}

TEST(Latency, UnsteadyLightCostsPrecisionNotTruth) {
    test::LightScene scene;
    scene.delay = microseconds(33000);
    for (const double amplitude : {0.05, 0.3, 0.6}) {
        scene.lamp_at = [=](double t) { return 1 + amplitude * std::sin(2 * M_PI * 57.3 * t); };
        const LatencyResult r = measure_latency(flashed(scene));
        ASSERT_FALSE(r.refusal) << amplitude << ": " << r.refusal->reason;
        EXPECT_NEAR(1e3 * r.median_s, 33, 3) << amplitude;
        EXPECT_LT(std::abs(r.median_s - 0.033), 4 * r.median_sigma_s + 1e-4) << amplitude;
        EXPECT_GE(r.light_delay_s, 0.033);
        EXPECT_LT(r.light_delay_s, 0.050);
    }
}

TEST(Latency, PicturesLeftOutAndFramesLostAreCounted) {
    test::LightScene scene;
    auto recording = flashed(scene);
    auto seen = recording;
    // The projector never showed orders 10 and 20; the cameras lost three frames of a steady time.
    auto shown = recording.orders;
    shown.erase(shown.begin() + 20);
    shown.erase(shown.begin() + 10);
    recording = scene.record(shown, shown.back().at + milliseconds(900));
    recording.orders = seen.orders;
    recording.frames.erase(recording.frames.begin() + 20, recording.frames.begin() + 23);
    const LatencyResult r = measure_latency(recording);
    ASSERT_FALSE(r.refusal) << r.refusal->reason;
    EXPECT_EQ(r.unseen, 2U);
    EXPECT_EQ(r.frames.lost, 3U);
    EXPECT_NEAR(1e3 * r.median_s, 40, 0.3);
    EXPECT_TRUE(says(r, "never became light"));
    EXPECT_TRUE(says(r, "lost 3 frames"));
}

TEST(Latency, InTheSimulatedRoomJitterAndRefreshAreSeenAndTheDelayToSetCoversEveryPicture) {
    for (const double refresh_hz : {0.0, 60.0}) {
        simulation::BoardRoomSettings settings;
        settings.preset = simulation::Preset::paper;
        settings.seed = 9;
        settings.light.whole_exposure = true;
        settings.light.untold_delay = milliseconds(31);
        settings.light.jitter = milliseconds(8);
        settings.light.refresh_hz = refresh_hz;
        test::CardRoom card(settings);
        const LightRecording recording = record_latency(card.bench);
        const LatencyResult r = measure_latency(recording);
        ASSERT_FALSE(r.refusal) << r.refusal->reason;
        const auto truth = test::true_delays_s(recording, card.room.true_lights());
        double mean = 0, square = 0;
        for (const double d : truth) mean += d / static_cast<double>(truth.size());
        for (const double d : truth) square += (d - mean) * (d - mean) / static_cast<double>(truth.size());
        EXPECT_NEAR(1e3 * r.median_s, 1e3 * mean, 2);
        EXPECT_LT(std::abs(r.median_s - mean), 3 * r.median_sigma_s);
        EXPECT_NEAR(1e3 * r.jitter_s, 1e3 * std::sqrt(square), 2.5);
        EXPECT_GE(r.light_delay_s, *std::max_element(truth.begin(), truth.end()));
        ASSERT_TRUE(r.promise);
        EXPECT_NEAR(1e3 * r.promise->delay_s, 25, 1e-6) << "as the simulated projector promises";
        EXPECT_GT(r.promise->broken, 20U);
        EXPECT_TRUE(says(r, "too early"));
    }
}

TEST(Recorder, LeavesTheProjectorDarkAlsoWhenACameraFails) {
    struct Failing : StereoCamera {
        StereoFrame grab(Instant, milliseconds) override { throw std::runtime_error("unplugged"); }
    } failing;
    struct Dark : Projector {
        int dark = 0;
        int width() const override { return 64; }
        int height() const override { return 48; }
        Instant show(const RgbImage&, Instant) override { return dark = 0, Instant{}; }
        void go_dark() noexcept override { dark = 1; }
    } projector;
    struct Still : Clock {
        Instant now() const override { return {}; }
    } clock;
    const LightBench bench{projector, failing, clock, [](Instant) {}, {}, {}};
    EXPECT_ANY_THROW(record_latency(bench));
    EXPECT_EQ(projector.dark, 1);
    EXPECT_ANY_THROW(record_response(bench));
    EXPECT_EQ(projector.dark, 1);
}

/// Cameras on a network, whose frames come a while after their exposure and wait until they are asked for, and a
/// projector that is late by its delay alone.
class RoomByWire : public Projector, public StereoCamera, public Clock {
public:
    explicit RoomByWire(Instant delay) : delay_(delay) {}
    int width() const override { return 64; }
    int height() const override { return 48; }
    Instant show(const RgbImage& picture, Instant) override {
        changes_.push_back({now_ + delay_, picture.pixels.front()[0] > 0});
        return now_ + milliseconds(30);  // what somebody set
    }
    void go_dark() noexcept override { changes_.push_back({now_ + delay_, false}); }
    StereoFrame grab(Instant not_before, milliseconds) override {
        const auto number = std::max(last_ + 1, (not_before + kInterval - Instant(1)) / kInterval);
        last_ = number;
        const Instant opened = number * kInterval;
        now_ = std::max(now_, opened + kExposure + kTransfer);
        const auto grey = static_cast<std::uint8_t>(40 + 160 * lit_share(opened, opened + kExposure));
        StereoFrame frame;
        frame.left = frame.right = GrayImage(64, 48, grey);
        frame.at = opened + kExposure / 2;
        frame.exposure = kExposure;
        frame.number = static_cast<std::uint64_t>(number);
        return frame;
    }
    Instant now() const override { return now_; }
    LightBench bench() {
        return {*this, *this, *this, [this](Instant at) { now_ = std::max(now_, at); }, {}, {}};
    }

private:
    static constexpr Instant kInterval = milliseconds(40), kExposure = milliseconds(10), kTransfer = milliseconds(32);
    double lit_share(Instant from, Instant to) const {
        Instant lit{}, since = from;
        bool on = false;
        for (const auto& [at, white] : changes_) {
            if (at >= to) break;
            if (on && at > since) lit += at - since;
            since = std::max(since, at), on = white;
        }
        if (on) lit += to - since;
        return seconds(lit) / seconds(to - from);
    }
    Instant delay_, now_ = milliseconds(1);
    Instant::rep last_ = 0;  ///< number of the frame that was given out last
    std::vector<std::pair<Instant, bool>> changes_;
};

/// Light that comes after frames were asked for met none while only frames after each order were asked for, and its
/// delay was known to the time between two exposures.
TEST(Recorder, ADelayOfSeveralFramesIsMeasuredAsASmallOne) {
    for (const int delay_ms : {20, 60, 75, 95, 137}) {
        RoomByWire room{milliseconds(delay_ms)};
        const LatencyResult r = measure_latency(record_latency(room.bench()));
        ASSERT_FALSE(r.refusal) << r.refusal->reason;
        EXPECT_NEAR(1e3 * r.median_s, delay_ms, 1) << delay_ms;
        EXPECT_LT(1e3 * r.median_sigma_s, 1) << delay_ms;
        EXPECT_GT(r.exact, 15U) << delay_ms;
        EXPECT_NEAR(1e3 * r.light_delay_s, delay_ms, 8) << delay_ms;
    }
}

/// No change was seen within an exposure, and frames were lost on both sides: the delay is known to the bounds that all
/// changes share, and no worse.
TEST(FitDelays, WithoutAnExactChangeTheDelayIsKnownToTheBoundsThatAllShare) {
    LatencyResult result;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> evenly(0, 1);
    double earliest = 1, latest = -1;
    for (std::size_t i = 0; i < 70; ++i) {
        LightDelay delay;
        delay.order = i;
        delay.at_least_s = 0.060 - 0.2 * evenly(random);
        delay.at_most_s = 0.095 + 0.2 * evenly(random);
        latest = std::max(latest, delay.at_least_s), earliest = std::min(earliest, delay.at_most_s);
        result.delays.push_back(delay);
    }
    fit_delays(0.01, milliseconds(10), result);
    EXPECT_NEAR(result.median_s, (earliest + latest) / 2, 1e-9);
    EXPECT_NEAR(result.median_sigma_s, (earliest - latest) / std::sqrt(12.0), 1e-3);
}

}  // namespace
}  // namespace planlight
