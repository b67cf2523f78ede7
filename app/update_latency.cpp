#include "app/update_latency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/without_numbers.h"

namespace planlight {

void UpdateLatency::add(const Session::Update& update) {
    constexpr Instant kPause = std::chrono::seconds(1);  // more is no frame that is missing, but a session that paused
    constexpr Instant kLate = std::chrono::milliseconds(30);
    ++updates;
    const Instant since = update.frame.at - last_at_;
    if (last_at_ > Instant{} && since > Instant{} && since < kPause && update.frame.number > last_number_) {
        interval_ = interval_ == Instant{} ? since : std::min(since, interval_ + interval_ / 32);
        const auto exposures = static_cast<std::size_t>(std::llround(seconds(since) / seconds(interval_)));
        const std::size_t pairs = update.frame.number - last_number_;
        skipped += pairs - 1;
        if (exposures > pairs) missed += exposures - pairs;
        followed_s += seconds(since);
    } else if (updates > 1) {
        ++pauses;
        paused_s += std::max(0.0, seconds(since));
    }
    last_at_ = update.frame.at;
    last_number_ = update.frame.number;
    if (!update.overlay.lit) {
        ++dark[without_numbers(update.overlay.reason)];
        return;
    }
    ++lit;
    const Instant worked = update.swapped_at - update.received_at;
    late += worked > kLate;
    overtaken += interval_ > Instant{} && worked > interval_;
    to_swap_ms.add(1e3 * std::max(0.0, seconds(update.swapped_at - update.frame.at)));
    from_arrival_ms.add(1e3 * std::max(0.0, seconds(worked)));
}

std::string UpdateLatency::sentence() const {
    if (lit == 0) return {};
    return fmt::format(
        "{} updates, {} lit, {} pairs skipped, {} exposures missed: {:.0f} / {:.0f} ms (median / 99 %) from "
        "mid-exposure to the display, of these {:.0f} / {:.0f} ms after the pictures came; {} later than 30 ms",
        updates, lit, skipped, missed, to_swap_ms.quantile(0.5), to_swap_ms.quantile(0.99),
        from_arrival_ms.quantile(0.5), from_arrival_ms.quantile(0.99), late);
}

std::string UpdateLatency::json() const {
    const auto part = [](const LogHistogram& of) {
        return fmt::format(R"({{"median_ms": {:.2f}, "p99_ms": {:.2f}, "worst_ms": {:.2f}, "histogram": "{}"}})",
                           of.quantile(0.5), of.quantile(0.99), of.distribution().worst, of.text());
    };
    nlohmann::json reasons = nlohmann::json::object();
    for (const auto& [reason, times] : dark) reasons[reason] = times;
    return fmt::format(
        "{{\n  \"updates\": {},\n  \"lit\": {},\n  \"skipped\": {},\n  \"missed\": {},\n  \"pauses\": {},\n  "
        "\"paused_s\": {:.3f},\n  \"followed_s\": {:.3f},\n  \"later_than_30_ms\": {},\n  "
        "\"later_than_a_frame\": {},\n  \"dark\": {},\n  \"mid_exposure_to_display\": {},\n  \"arrival_to_display\": "
        "{}\n}}\n",
        updates, lit, skipped, missed, pauses, paused_s, followed_s, late, overtaken, reasons.dump(), part(to_swap_ms),
        part(from_arrival_ms));
}

}  // namespace planlight
