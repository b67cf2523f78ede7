#include "registration/projector_measurement/fit_delays.h"
#include "planning_io/types/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace planlight {
namespace {

double below(double z) {
    return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

/// Minus the logarithm of the likelihood; a hundredth of the changes may be anything (a picture that came late).
double cost(const std::vector<LightDelay>& delays, double reading_s, double middle_s, double spread_s) {
    constexpr double kAnything = 0.01, kRange_s = 0.1;
    double sum = 0;
    for (const LightDelay& d : delays) {
        double likelihood = 0, wide_s = 0;
        if (d.exact) {
            const double s = std::hypot(spread_s, reading_s), z = (d.at_least_s - middle_s) / s;
            wide_s = reading_s;
            likelihood = reading_s * std::exp(-z * z / 2) / (s * std::sqrt(2 * M_PI));
        } else {
            const double s = std::hypot(spread_s, reading_s);
            wide_s = d.at_most_s - d.at_least_s;
            likelihood = below((d.at_most_s - middle_s) / s) - below((d.at_least_s - middle_s) / s);
        }
        sum -= std::log((1 - kAnything) * likelihood + kAnything * std::min(1.0, wide_s / kRange_s) + 1e-300);
    }
    return sum;
}

/// The curvature of a function along one direction, by differences.
template <class Function>
double curvature(Function f, double x, double step) {
    return (f(x + step) - 2 * f(x) + f(x - step)) / (step * step);
}

}  // namespace

void fit_delays(double noise, Instant exposure, LatencyResult& result) {
    constexpr double kLeastSpread_s = 2e-5, kMostSpread_s = 0.1;
    const double reading_s = std::max(1e-5, noise * seconds(exposure));
    double low = std::numeric_limits<double>::max(), high = -low;
    double earliest = low, latest = high;
    for (const LightDelay& d : result.delays) {
        low = std::min(low, d.at_least_s), high = std::max(high, d.at_most_s);
        earliest = std::min(earliest, d.at_most_s), latest = std::max(latest, d.at_least_s);
    }
    double best = std::numeric_limits<double>::max(), middle = (low + high) / 2, spread = 0.005;
    const auto look = [&](double from, double to, double step, double spread_from, double spread_to, double factor) {
        for (double s = spread_from; s <= spread_to; s *= factor)
            for (double m = from; m <= to; m += step)
                if (const double c = cost(result.delays, reading_s, m, s); c < best) best = c, middle = m, spread = s;
    };
    look(low, high, std::max(2e-4, (high - low) / 400), kLeastSpread_s, kMostSpread_s, 1.5);
    for (double step = std::max(2e-4, (high - low) / 400), factor = 1.5; step > 2e-6;
         step /= 4, factor = std::sqrt(factor)) {
        const double m = middle, s = spread;
        look(m - 2 * step, m + 2 * step, step / 2, std::max(kLeastSpread_s, s / (factor * factor)), s * factor * factor,
             std::sqrt(factor));
    }
    const bool flat = result.exact == 0 && latest < earliest;
    if (flat) middle = (latest + earliest) / 2;  // any of them will do
    result.median_s = middle;
    result.jitter_s = spread <= 2 * kLeastSpread_s ? 0 : spread;
    result.earliest_s = earliest;
    result.latest_s = latest;
    const double step = std::max(spread, reading_s) / 4;
    const double bend = curvature([&](double m) { return cost(result.delays, reading_s, m, spread); }, middle, step);
    // Without an exact change the likelihood may be flat: then every delay between the bounds will do. Without jitter
    // it has no bend at all to go by.
    const double flat_s = flat ? (earliest - latest) / std::sqrt(12.0) : 0;
    const double bent_s = bend > 0 ? 1 / std::sqrt(bend) : (high - low) / std::sqrt(12.0);
    result.median_sigma_s = std::max({flat && result.jitter_s == 0 ? 0 : bent_s, flat_s,
                                      reading_s / std::sqrt(static_cast<double>(result.delays.size()))});
    // A projector whose pictures change in step with the cameras never shows a change to an exposure, and all bounds
    // lie alike: they do not narrow each other.
    if (result.refresh_hz == 0 && 10 * result.exact < result.delays.size() && result.jitter_s > 0) {
        std::vector<double> widths;
        for (const LightDelay& d : result.delays) widths.push_back(d.at_most_s - d.at_least_s);
        const auto half = median(widths);
        result.blind_s = half;
        result.median_sigma_s = std::hypot(result.median_sigma_s, result.blind_s / std::sqrt(12.0));
    }
    const double bend_of_spread = curvature(
        [&](double s) { return cost(result.delays, reading_s, middle, std::max(s, 1e-6)); }, spread, spread / 4);
    result.jitter_sigma_s = bend_of_spread > 0 ? 1 / std::sqrt(bend_of_spread) : spread;
}

}  // namespace planlight
