#include "registration/projector/measure_cycle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace planlight {
namespace {

constexpr std::size_t kLeastFrames = 24;

/// Brightness of the two halves of the tiles, frame by frame, without mean and slow drift.
struct Halves {
    std::vector<double> at_s, a, b;
    double mean = 0;
};

/// Straight line taken out; returns the mean.
double flatten(const std::vector<double>& at_s, std::vector<double>& v) {
    const auto n = static_cast<double>(v.size());
    double t = 0, m = 0, tt = 0, tm = 0;
    for (std::size_t i = 0; i < v.size(); ++i) t += at_s[i] / n, m += v[i] / n;
    for (std::size_t i = 0; i < v.size(); ++i) tt += (at_s[i] - t) * (at_s[i] - t), tm += (at_s[i] - t) * (v[i] - m);
    const double slope = tt > 0 ? tm / tt : 0;
    for (std::size_t i = 0; i < v.size(); ++i) v[i] -= m + slope * (at_s[i] - t);
    return m;
}

Halves halves_of(const LightRecording& recording, const std::vector<std::size_t>& frames,
                 const std::vector<std::size_t>& tiles) {
    std::vector<std::size_t> even, odd;
    for (const std::size_t t : tiles) ((t % kTilesAcross + t / kTilesAcross) % 2 == 0 ? even : odd).push_back(t);
    Halves halves;
    for (const std::size_t f : frames) {
        halves.at_s.push_back(seconds(recording.frames[f].at));
        halves.a.push_back(mean_of(recording.frames[f], even));
        halves.b.push_back(mean_of(recording.frames[f], odd));
    }
    halves.mean = (flatten(halves.at_s, halves.a) + flatten(halves.at_s, halves.b)) / 2;
    return halves;
}

struct Covariance {
    double common = 0, sigma = 0, correlation = 0;
};

Covariance covariance_of(const Halves& h) {
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < h.a.size(); ++i) ab += h.a[i] * h.b[i], aa += h.a[i] * h.a[i], bb += h.b[i] * h.b[i];
    const double freedom = static_cast<double>(h.a.size()) - 2;
    Covariance c;
    c.common = ab / freedom;
    c.sigma = std::sqrt((aa * bb / (freedom * freedom) + c.common * c.common) / freedom);
    c.correlation = aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
    return c;
}

/// The frequency whose sine explains most, up to half the frame rate; empty when none explains half of the variation.
std::optional<double> strongest_hz(const Halves& h, double frames_hz) {
    double all = 0;
    std::vector<double> v(h.a.size());
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = (h.a[i] + h.b[i]) / 2, all += v[i] * v[i];
    const double lasted = h.at_s.back() - h.at_s.front();
    double best = 0, best_hz = 0;
    for (double hz = 0.5 / lasted; hz <= frames_hz / 2; hz += 0.1 / lasted) {
        double cc = 0, ss = 0, cs = 0, vc = 0, vs = 0;
        for (std::size_t i = 0; i < v.size(); ++i) {
            const double phase = 2 * M_PI * hz * (h.at_s[i] - h.at_s[0]), c = std::cos(phase), s = std::sin(phase);
            cc += c * c, ss += s * s, cs += c * s, vc += v[i] * c, vs += v[i] * s;
        }
        const double det = cc * ss - cs * cs;
        if (det < 1e-9 * cc * ss + 1e-9) continue;
        const double power = (ss * vc * vc - 2 * cs * vc * vs + cc * vs * vs) / det;
        if (power > best) best = power, best_hz = hz;
    }
    if (all <= 0 || best < 0.5 * all) return std::nullopt;
    return best_hz;
}

double aliased(double hz, double frames_hz) {
    return std::abs(hz - frames_hz * std::round(hz / frames_hz));
}

std::vector<double> usual_cycles(bool room, double refresh_hz) {
    if (room) return {100, 120};
    std::vector<double> cycles;
    for (int k = 1; k <= 6; ++k) cycles.push_back(k * refresh_hz);
    return cycles;
}

std::string name_of(Rgb c) {
    static const std::map<Rgb, std::string> kNames{{{0, 0, 0}, "black"},
                                                   {{255, 255, 255}, "white"},
                                                   {{255, 0, 0}, "red"},
                                                   {{0, 255, 0}, "green"},
                                                   {{0, 0, 255}, "blue"}};
    const auto found = kNames.find(c);
    return found == kNames.end() ? fmt::format("{} {} {}", c[0], c[1], c[2]) : found->second;
}

CycleRun measured_run(const LightRecording& recording, const std::vector<std::size_t>& frames, const LitTiles& lit,
                      Rgb colour, const std::optional<Covariance>& room, double frames_hz,
                      const CycleSettings& settings) {
    const Halves halves = halves_of(recording, frames, lit.tiles);
    const Covariance c = covariance_of(halves);
    CycleRun run;
    run.name = name_of(colour);
    run.frames = frames.size();
    run.light_grey = room ? halves.mean - lit.black : halves.mean;
    run.variation_grey = std::sqrt(std::max(0.0, c.common));
    const double own = c.common - (room ? room->common : 0), sigma = std::hypot(c.sigma, room ? room->sigma : 0);
    const double light = std::max(run.light_grey, 1.0);
    run.variation = std::sqrt(std::max(0.0, own)) / light;
    run.variation_sigma = own > sigma ? sigma / (2 * std::sqrt(own)) / light : std::sqrt(sigma) / light;
    run.at_most = std::sqrt(std::max(0.0, own) + 2 * sigma) / light;
    const double chance = 4 / std::sqrt(static_cast<double>(frames.size()));
    run.varies = c.correlation > chance && own > 3 * sigma * chance && run.variation > settings.noticed;
    if (c.correlation > chance) run.seen_hz = strongest_hz(halves, frames_hz);
    if (run.seen_hz) {
        const double near = 1 / (halves.at_s.back() - halves.at_s.front());
        for (const double hz : usual_cycles(!room, settings.refresh_hz))
            if (std::abs(aliased(hz, frames_hz) - *run.seen_hz) < near) run.cycles_hz.push_back(hz);
    }
    for (std::size_t i = 0; i < halves.a.size(); ++i)
        run.trace.push_back(static_cast<float>((halves.a[i] + halves.b[i]) / 2 / light));
    return run;
}

/// The shortest exposure, not under the present one, that holds whole cycles of both.
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

void find_cure(const CycleSettings& settings, CycleResult& result) {
    std::vector<double> needed;
    bool told = true;
    const auto add = [&](const CycleRun& run, double otherwise_hz) {
        told = told && run.cycles_hz.size() == 1;
        needed.push_back(run.cycles_hz.size() == 1 ? run.cycles_hz.front() : otherwise_hz);
    };
    for (const CycleRun& run : result.runs) {
        if (!run.varies) continue;
        const bool room = run.name == "black";
        // Half grey would be enough for a wheel's cycle, but every cycle of a projector is over after one of its
        // pictures.
        if (room)
            add(run, 100);
        else
            add(run, settings.refresh_hz);
    }
    if (needed.empty()) return;
    std::sort(needed.begin(), needed.end());
    result.cycle_is_told = told;
    result.exposure_to_set_s = whole_cycles_s(result.exposure_s, needed);
}

}  // namespace

CycleResult measure_cycle(const LightRecording& recording, const CycleSettings& settings) {
    CycleResult result;
    const LitTiles lit = find_lit_tiles(recording);
    if (lit.refusal) {
        result.refusal = lit.refusal;
        return result;
    }
    result.timing = frame_timing(recording);
    result.frames_hz = 1 / result.timing.interval_s;
    result.exposure_s = seconds(recording.frames.front().exposure);
    const auto steady = steady_frames(recording);
    const auto frames_of = [&](std::size_t o) {
        return steady[o].size() >= kLeastFrames ? steady[o] : std::vector<std::size_t>{};
    };
    std::optional<Covariance> room;
    double lasted = 0;
    for (const bool dark : {true, false})
        for (std::size_t o = 0; o < recording.orders.size(); ++o) {
            const auto frames = frames_of(o);
            const bool black = recording.orders[o].colour == Rgb{0, 0, 0};
            if (frames.empty() || black != dark || recording.orders[o].covered) continue;
            result.runs.push_back(
                measured_run(recording, frames, lit, recording.orders[o].colour, room, result.frames_hz, settings));
            lasted =
                std::max(lasted, seconds(recording.frames[frames.back()].at - recording.frames[frames.front()].at));
            if (dark && !room) room = covariance_of(halves_of(recording, frames, lit.tiles));
        }
    if (!room || result.runs.size() < 2) {
        result.refusal = {
            fmt::format("a run of {} frames in a row is missing for {}", kLeastFrames, room ? "white" : "black"),
            "Let the cameras run while one picture stands still, for black and for white at least."};
        return result;
    }
    result.room_varies = result.runs.front().varies;
    for (std::size_t i = 1; i < result.runs.size(); ++i) {
        result.projector_varies = result.projector_varies || result.runs[i].varies;
        if (result.runs[i].varies) result.worst = std::max(result.worst, result.runs[i].variation);
    }
    for (const bool dark : {true, false})
        for (const double hz : usual_cycles(dark, settings.refresh_hz))
            if (aliased(hz, result.frames_hz) < 0.5 / lasted) result.unseen_hz.push_back(hz);
    find_cure(settings, result);
    return result;
}

}  // namespace planlight
