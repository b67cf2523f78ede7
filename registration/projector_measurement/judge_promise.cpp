#include "registration/projector_measurement/judge_promise.h"
#include "planning_io/types/statistics.h"

#include <algorithm>
#include <cmath>

namespace planlight {

void judge_promise(const LightRecording& recording, LatencyResult& result) {
    constexpr double kNoticed_s = 0.0005, kMargin_s = 0.001;
    std::vector<double> promised;
    LatencyResult::Promise promise;
    double latest_s = 0, quickest_return_s = 1e9;  // after the return of `show`; of `show` itself
    for (const LightDelay& delay : result.delays) {
        const LightOrder& order = recording.orders[delay.order];
        const double return_s = order.returned ? seconds(*order.returned - order.at) : 0;
        latest_s = std::max(latest_s, delay.at_least_s + result.blind_s - return_s);
        quickest_return_s = std::min(quickest_return_s, return_s);
        if (!order.promised) continue;
        promised.push_back(seconds(*order.promised - order.at));
        const double early_s = delay.at_least_s - promised.back();
        promise.broken += early_s > kNoticed_s;
        promise.too_early_s = std::max(promise.too_early_s, early_s);
    }
    if (!promised.empty()) {
        promise.orders = promised.size();
        const auto middle = median(promised);
        promise.delay_s = middle;
        result.promise = promise;
    }
    const double spread_s =
        result.median_s - quickest_return_s + 3 * std::hypot(result.jitter_s, result.median_sigma_s);
    result.light_delay_s = std::ceil(1e3 * (std::max({latest_s, spread_s, 0.0}) + kMargin_s)) / 1e3;
}

}  // namespace planlight
