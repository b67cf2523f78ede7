#include "registration/projector_measurement/find_refreshes.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace planlight {
namespace {

using Complex = std::complex<double>;

Complex mean_vector(const std::vector<double>& lit_s, double hz) {
    Complex sum = 0;
    for (const double t : lit_s) sum += std::polar(1.0, 2 * M_PI * hz * t);
    return sum / static_cast<double>(lit_s.size());
}

double off_refresh_s(const Refreshes& r, double t) {
    const double turns = (t - r.first_s) * r.hz;
    return (turns - std::round(turns)) / r.hz;
}

/// The best of all within 1 %, to a thousandth of a turn over the recording.
Refreshes fitted(const std::vector<double>& lit_s, double nominal_hz) {
    const auto [first, last] = std::minmax_element(lit_s.begin(), lit_s.end());
    const double lasted_s = std::max(0.1, *last - *first);
    double best = -1, hz = nominal_hz;
    const auto look = [&](double from, double to, double step) {
        for (double f = from; f <= to; f += step)
            if (const double length = std::abs(mean_vector(lit_s, f)); length > best) best = length, hz = f;
    };
    look(0.99 * nominal_hz, 1.01 * nominal_hz, 0.05 / lasted_s);
    for (double step = 0.01 / lasted_s; step > 1e-4 / lasted_s; step /= 5) look(hz - 6 * step, hz + 6 * step, step);
    return {std::arg(mean_vector(lit_s, hz)) / (2 * M_PI * hz), hz, 0};
}

/// A change waits for its refresh, up to a whole turn: the delay before that, as most of the changes allow.
double common_delay_s(const std::vector<LightDelay>& delays, double turn_s) {
    std::vector<std::pair<double, int>> ends;  // of the ranges that allow it
    for (const LightDelay& d : delays) ends.emplace_back(d.at_least_s - turn_s, 1), ends.emplace_back(d.at_most_s, -1);
    std::sort(ends.begin(), ends.end());
    int open = 0, most = 0;
    double from = ends.front().first, to = from;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        open += ends[i].second;
        if (open > most && i + 1 < ends.size()) most = open, from = ends[i].first, to = ends[i + 1].first;
    }
    return (from + to) / 2;
}

}  // namespace

std::optional<Refreshes> find_refreshes(const std::vector<LightDelay>& delays, const std::vector<double>& at_s,
                                        double nominal_hz, double reading_s) {
    constexpr std::size_t kLeast = 8;
    constexpr double kFinest_s = 2e-4;
    std::vector<double> lit_s;
    for (std::size_t i = 0; i < delays.size(); ++i)
        if (delays[i].exact) lit_s.push_back(at_s[i] + delays[i].at_least_s);
    if (lit_s.size() < kLeast) return std::nullopt;
    const double all = static_cast<double>(lit_s.size()), tolerance_s = std::max(kFinest_s, 4 * reading_s);
    Refreshes found = fitted(lit_s, nominal_hz);
    std::erase_if(lit_s, [&](double t) { return std::abs(off_refresh_s(found, t)) > tolerance_s; });
    if (static_cast<double>(lit_s.size()) < 0.9 * all) return std::nullopt;
    found = fitted(lit_s, nominal_hz);
    found.tolerance_s = tolerance_s;
    return found;
}

std::optional<std::vector<LightDelay>> at_refreshes(const Refreshes& refreshes, std::vector<LightDelay> delays,
                                                    const std::vector<double>& at_s) {
    std::size_t without = 0;
    for (std::size_t i = 0; i < delays.size(); ++i) {
        LightDelay& delay = delays[i];
        if (delay.exact) continue;
        const auto number = [&](double delay_s) { return (at_s[i] + delay_s - refreshes.first_s) * refreshes.hz; };
        const auto delay_of = [&](double n) { return refreshes.first_s + n / refreshes.hz - at_s[i]; };
        const double first = std::ceil(number(delay.at_least_s - refreshes.tolerance_s)),
                     last = std::floor(number(delay.at_most_s + refreshes.tolerance_s));
        if (last < first) {
            ++without;
            delay.at_least_s = delay.at_most_s = (delay.at_least_s + delay.at_most_s) / 2;
            continue;
        }
        delay.at_least_s = delay_of(first), delay.at_most_s = delay_of(last);
    }
    if (10 * without > delays.size()) return std::nullopt;
    const double turn_s = 1 / refreshes.hz, expected_s = common_delay_s(delays, turn_s) + turn_s / 2;
    for (LightDelay& delay : delays) {
        const double refreshes_later = std::round((expected_s - delay.at_least_s) * refreshes.hz),
                     most = std::round((delay.at_most_s - delay.at_least_s) * refreshes.hz);
        delay.at_least_s += std::clamp(refreshes_later, 0.0, most) * turn_s;
        delay.at_most_s = delay.at_least_s;
        delay.exact = true;
    }
    return delays;
}

}  // namespace planlight
