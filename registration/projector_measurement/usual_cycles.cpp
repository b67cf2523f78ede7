#include "registration/projector_measurement/usual_cycles.h"

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

double from_whole(double hz, double frames_hz) {
    return std::abs(hz - frames_hz * std::round(hz / frames_hz));
}

}  // namespace

std::vector<UsualCycle> usual_cycles_of_lamps() {
    constexpr double kGridStrays_hz = 0.4;  // twice 0.2 Hz
    return {{100, kGridStrays_hz}, {120, kGridStrays_hz}};
}

std::vector<UsualCycle> usual_cycles_of_projectors(double refresh_hz, double tolerance_hz) {
    std::vector<UsualCycle> cycles;
    for (int k = 1; k <= 6; ++k) cycles.push_back({k * refresh_hz, k * tolerance_hz});
    return cycles;
}

std::vector<double> cycles_that_look_like(double seen_hz, double seen_sigma_hz, const std::vector<UsualCycle>& usual,
                                          double frames_hz) {
    std::vector<double> cycles;
    for (const UsualCycle& cycle : usual) {
        const double off =
            std::min(from_whole(cycle.hz - seen_hz, frames_hz), from_whole(cycle.hz + seen_hz, frames_hz));
        if (off <= cycle.tolerance_hz + 3 * seen_sigma_hz) cycles.push_back(cycle.hz);
    }
    return cycles;
}

std::vector<double> cycles_that_stand_still(const std::vector<UsualCycle>& usual, double frames_hz, double lasted_s) {
    std::vector<double> cycles;
    for (const UsualCycle& cycle : usual)
        if (from_whole(cycle.hz, frames_hz) - cycle.tolerance_hz < 0.5 / lasted_s) cycles.push_back(cycle.hz);
    return cycles;
}

double most_variation(double exposure_s, double lowest_hz) {
    const double turns = exposure_s * lowest_hz, whole = std::floor(turns + 1e-9);
    if (turns <= 0) return 1e9;
    return std::sqrt(std::max(0.0, ((whole + 1) / turns - 1) * (1 - whole / turns)));
}

double whole_cycles_s(double at_least_s, const std::vector<double>& cycles_hz) {
    constexpr double kLongest_s = 0.2;
    for (int k = 1; k / cycles_hz.front() < kLongest_s; ++k) {
        const double exposure_s = k / cycles_hz.front();
        if (exposure_s < 0.98 * at_least_s) continue;
        if (std::all_of(cycles_hz.begin(), cycles_hz.end(), [&](double hz) {
                const double turns = exposure_s * hz;
                return turns > 0.5 && std::abs(turns - std::round(turns)) < 0.02;
            }))
            return exposure_s;
    }
    return 0;
}

}  // namespace planlight
