#include "app/update_latency.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace planlight {
namespace {

using std::chrono::milliseconds;

/// The update of a pair that was exposed at `at_ms`, came 40 ms later and was on the display `worked_ms` after that.
Session::Update update(int number, double at_ms, double worked_ms, bool lit = true) {
    Session::Update update;
    update.frame.number = static_cast<std::uint64_t>(number);
    update.frame.at = from_seconds(at_ms / 1e3);
    update.received_at = update.frame.at + milliseconds(40);
    update.overlay.lit = lit;
    if (lit) update.swapped_at = update.received_at + from_seconds(worked_ms / 1e3);
    return update;
}

TEST(UpdateLatency, CountsWhatWasUsedSkippedMissedAndLate) {
    UpdateLatency latency;
    EXPECT_EQ(latency.sentence(), "");
    latency.add(update(1, 1000, 10));
    latency.add(update(2, 1040, 10));
    latency.add(update(3, 1080, 35));  // late
    latency.add(update(5, 1160, 10));  // pair 4 came and was left out
    latency.add(update(6, 1240, 50));  // of 1200 no pair came; later than the next frame as well
    latency.add(update(7, 1280, 10, false));
    EXPECT_EQ(latency.updates, 6u);
    EXPECT_EQ(latency.lit, 5u);
    EXPECT_EQ(latency.skipped, 1u);
    EXPECT_EQ(latency.missed, 1u);
    EXPECT_EQ(latency.late, 2u);
    EXPECT_EQ(latency.overtaken, 1u);
    EXPECT_EQ(latency.pauses, 0u);
    EXPECT_NEAR(latency.followed_s, 0.28, 1e-9);  // seven exposures of 40 ms
    EXPECT_EQ(latency.updates - 1 + latency.skipped + latency.missed, 7u) << "none of them is unaccounted for";
    EXPECT_NEAR(latency.to_swap_ms.quantile(0.5), 50, 0.5);
    EXPECT_NEAR(latency.from_arrival_ms.quantile(0.99), 50, 0.5);
}

TEST(UpdateLatency, APauseIsNoMissingFrame) {
    UpdateLatency latency;
    latency.add(update(1, 1000, 10));
    latency.add(update(2, 1040, 10));
    latency.add(update(90, 9000, 10));
    EXPECT_EQ(latency.skipped, 0u);
    EXPECT_EQ(latency.missed, 0u);
    latency.add(update(1, 9100, 10));  // the cameras were opened anew, and count from one
    EXPECT_EQ(latency.pauses, 2u);
    EXPECT_NEAR(latency.paused_s, 8.06, 1e-9);
    EXPECT_NEAR(latency.followed_s, 0.04, 1e-9);
}

TEST(UpdateLatency, ItsJsonIsOne) {
    UpdateLatency latency;
    EXPECT_EQ(nlohmann::json::parse(latency.json()).at("updates"), 0);
    latency.add(update(1, 1000, 10));
    const auto json = nlohmann::json::parse(latency.json());
    EXPECT_NEAR(json.at("mid_exposure_to_display").at("median_ms").get<double>(), 50, 0.5);
    EXPECT_EQ(json.at("lit"), 1);
    EXPECT_EQ(json.at("dark").size(), 0u);
}

TEST(UpdateLatency, CountsDarknessByItsReason) {
    UpdateLatency latency;
    for (const char* reason :
         {"the last pose is 79 ms old (at most 75 ms)", "the last pose is 121.5 ms old (at most 75 ms)",
          "the patient is not tracked: \"2\" markers"}) {
        Session::Update dark = update(1, 1000, 10, false);
        dark.overlay.reason = reason;
        latency.add(dark);
    }
    const auto json = nlohmann::json::parse(latency.json());
    EXPECT_EQ(json.at("dark").at("the last pose is … ms old (at most … ms)"), 2);
    EXPECT_EQ(json.at("dark").at("the patient is not tracked: \"…\" markers"), 1);
}

}  // namespace
}  // namespace planlight
