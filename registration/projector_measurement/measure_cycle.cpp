#include "registration/projector_measurement/measure_cycle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "registration/projector_measurement/fit_wave.h"
#include "registration/projector_measurement/usual_cycles.h"

namespace planlight {
namespace {

constexpr std::size_t kLeastFrames = 24;
constexpr Rgb kBlack{0, 0, 0};

/// All steady frames of one colour.
struct Visits {
    Rgb colour{};
    std::size_t number = 0;  ///< of orders with steady frames: what is far apart in time
    std::vector<std::size_t> frames;
    PairedTrace trace;
};

void add_frame(const LightRecording& recording, std::size_t f, const std::vector<std::size_t>& even,
               const std::vector<std::size_t>& odd, Visits& visits) {
    visits.frames.push_back(f);
    visits.trace.at_s.push_back(seconds(recording.frames[f].at));
    visits.trace.a.push_back(mean_of(recording.frames[f], even));
    visits.trace.b.push_back(mean_of(recording.frames[f], odd));
}

/// Colour by colour in the order of their first coming, black first; those with too few frames left out.
std::vector<Visits> visits_of(const LightRecording& recording, const std::vector<std::size_t>& tiles) {
    std::vector<std::size_t> even, odd;
    for (const std::size_t t : tiles) ((t % kTilesAcross + t / kTilesAcross) % 2 == 0 ? even : odd).push_back(t);
    std::vector<Visits> all{{kBlack, 0, {}, {}}};
    const auto steady = steady_frames(recording);
    for (std::size_t o = 0; o < recording.orders.size(); ++o) {
        const LightOrder& order = recording.orders[o];
        if (order.covered || steady[o].empty()) continue;
        auto found = std::find_if(all.begin(), all.end(), [&](const Visits& v) { return v.colour == order.colour; });
        if (found == all.end()) found = all.insert(all.end(), {order.colour, 0, {}, {}});
        ++found->number;
        for (const std::size_t f : steady[o]) add_frame(recording, f, even, odd, *found);
    }
    std::erase_if(all, [](const Visits& v) { return v.frames.size() < kLeastFrames; });
    return all;
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

/// The largest correlation of two halves that only have noise in common.
double chance(const Visits& visits) {
    return 4 / std::sqrt(static_cast<double>(visits.frames.size()));
}

/// What all runs are judged against.
struct Beside {
    std::vector<double> lamps_hz;  ///< as the frames see them; empty: steady
    Covariance room;               ///< what the lamps vary beyond that one sine
    double black_grey = 0;
    double frames_hz = 0, exposure_s = 0;
};

/// Multiples of the frequency that is seen: as many as the widest part of a turn without a frame lets be told, and of
/// those that the frames see alike only the lowest.
std::vector<double> waves_of(double seen_hz, double gap, double lasted_s, const Beside& beside) {
    constexpr int kMost = 6;
    std::vector<double> waves{seen_hz}, taken{0, seen_hz};
    taken.insert(taken.end(), beside.lamps_hz.begin(), beside.lamps_hz.end());
    for (int m = 2; m <= std::min(kMost, static_cast<int>(0.45 / gap)); ++m) {
        const double seen = std::abs(m * seen_hz - beside.frames_hz * std::round(m * seen_hz / beside.frames_hz));
        if (std::all_of(taken.begin(), taken.end(), [&](double hz) { return std::abs(hz - seen) > 1 / lasted_s; }))
            waves.push_back(m * seen_hz), taken.push_back(seen);
    }
    return waves;
}

/// Slower than that, a beat is not told from drift; with a wider part of a turn unmet, its size is not told.
constexpr double kFewestTurns = 2.5, kWidestGap = 0.35;

/// The frames met a part of the cycle only: nothing is known of the rest but what an exposure can vary at all.
void leave_untold(const std::vector<UsualCycle>& usual, double exposure_s, CycleRun& run) {
    run.size_is_told = false;
    run.at_most = 0;
    for (const UsualCycle& cycle : usual) run.at_most = std::max(run.at_most, most_variation(exposure_s, cycle.hz));
    run.variation_sigma = run.at_most / 2;
}

/// `seen_hz`: of the light that varies, the projector's or for black the lamps'; empty: no one frequency.
CycleRun measured_run(const Visits& visits, const std::optional<double>& seen_hz, const Beside& beside,
                      const std::vector<UsualCycle>& usual, double noticed) {
    const bool black = visits.colour == kBlack;
    CycleRun run;
    run.name = name_of(visits.colour);
    run.frames = visits.frames.size();
    double mean = 0, mean_sigma = 0;
    const Covariance met = covariance_beside(visits.trace, beside.lamps_hz, &mean);
    const double lamps = black ? 0 : beside.room.common, lamps_sigma = black ? 0 : beside.room.sigma;
    double variance = met.common - lamps, sigma = std::hypot(met.sigma, lamps_sigma);
    const bool beyond_noise = met.correlation > chance(visits) && variance > 3 * sigma * chance(visits);
    if (beyond_noise && seen_hz) {
        const double gap = widest_gap(visits.trace.at_s, *seen_hz), lasted_s = visits.trace.lasted_s();
        const WaveFit wave = fit_wave(visits.trace, waves_of(*seen_hz, gap, lasted_s, beside), beside.lamps_hz);
        if (wave.left_over.common < met.common / 2) {
            run.seen_hz = seen_hz;
            run.cycles_hz = cycles_that_look_like(*seen_hz, 0.1 / lasted_s, usual, beside.frames_hz);
            run.size_is_told = gap<kWidestGap&& * seen_hz * lasted_s> kFewestTurns;
        }
        if (run.seen_hz && run.size_is_told) {
            variance = wave.variance - lamps, sigma = std::hypot(wave.variance_sigma, lamps_sigma);
            mean = wave.mean, mean_sigma = wave.mean_sigma;
        }
    }
    // Lamps that the frames see as they see the wheel: whether both rise together is not known.
    if (beyond_noise && beside.lamps_hz.empty() && lamps > 0)
        sigma = std::hypot(sigma, std::sqrt(2 * std::max(0.0, variance) * lamps));
    if (beyond_noise && !run.seen_hz)  // irregular: as well known as the visits are many
        sigma = std::hypot(sigma, variance * std::sqrt(2.0 / static_cast<double>(visits.number)));
    variance = std::max(0.0, variance);
    run.light_grey = mean - beside.black_grey;
    const double light = std::max(run.light_grey, 1.0);
    constexpr double kAtBest = 0.01;  // of the variation: corners of the wave between the phases that were met
    run.variation = std::sqrt(variance) / light;
    const double mean_share = std::hypot(mean_sigma / light, beyond_noise ? kAtBest : 0);
    run.variation_sigma = std::hypot((variance > sigma ? sigma / (2 * std::sqrt(variance)) : std::sqrt(sigma)) / light,
                                     run.variation * mean_share);
    run.at_most = std::max(run.variation + 2 * run.variation_sigma, std::sqrt(variance + 2 * sigma) / light);
    run.varies = beyond_noise && run.variation > noticed;
    for (std::size_t i = 0; i < visits.frames.size(); ++i)
        run.trace.push_back(static_cast<float>(((visits.trace.a[i] + visits.trace.b[i]) / 2 - mean) / light));
    return run;
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

/// True when a colour varies at the lamps' frequency, as well as the frames tell it, by far more than black does.
bool looks_alike(const std::vector<Visits>& all, double lamps_hz, double frames_hz) {
    constexpr double kFarMore = 4;
    const double black = covariance_beside(all.front().trace, {}).common;
    return std::any_of(all.begin() + 1, all.end(), [&](const Visits& visits) {
        if (covariance_beside(visits.trace, {}).common < kFarMore * black) return false;
        const auto seen_hz = strongest_hz({visits.trace}, frames_hz / 2, {});
        return seen_hz && std::abs(*seen_hz - lamps_hz) < 1 / visits.trace.lasted_s();
    });
}

/// The room by its black, then all colours together: they turn with one wheel.
void measure_runs(const std::vector<Visits>& all, const CycleSettings& settings, CycleResult& result) {
    const auto of_lamps = usual_cycles_of_lamps();
    const auto of_projectors = usual_cycles_of_projectors(settings.refresh_hz, settings.refresh_tolerance_hz);
    Beside beside;
    beside.frames_hz = result.frames_hz;
    beside.exposure_s = result.exposure_s;
    const auto strongest = [&](const std::vector<PairedTrace>& traces) {
        return traces.empty() ? std::nullopt : strongest_hz(traces, result.frames_hz / 2, beside.lamps_hz);
    };
    const auto unsteady = [&](const Visits& v) {
        return covariance_beside(v.trace, beside.lamps_hz).correlation > chance(v);
    };
    const Visits& black = all.front();
    const auto lamps_hz = unsteady(black) ? strongest({black.trace}) : std::nullopt;
    result.runs.push_back(measured_run(black, lamps_hz, beside, of_lamps, settings.noticed));
    // Too little for lamps may be the projector's own leak; what looks like the lamps, but is more than they are, too.
    if (lamps_hz && result.runs.front().varies && !looks_alike(all, *lamps_hz, result.frames_hz))
        beside.lamps_hz = {*lamps_hz};
    beside.room = covariance_beside(black.trace, beside.lamps_hz, &beside.black_grey);
    if (!result.runs.front().size_is_told) leave_untold(of_lamps, result.exposure_s, result.runs.front());
    std::vector<PairedTrace> wheel;
    for (const Visits& visits : all)
        if (visits.colour != kBlack && unsteady(visits)) wheel.push_back(visits.trace);
    const auto wheel_hz = strongest(wheel);
    double lasted_s = black.trace.lasted_s();
    for (const Visits& visits : all) {
        if (visits.colour == kBlack) continue;
        result.runs.push_back(measured_run(visits, wheel_hz, beside, of_projectors, settings.noticed));
        lasted_s = std::max(lasted_s, visits.trace.lasted_s());
    }
    // One wheel: where it beats too slowly for one colour, another that looked steady was met at its even part only.
    const auto colours = result.runs.begin() + 1;
    if (std::any_of(colours, result.runs.end(), [](const CycleRun& run) { return !run.size_is_told; }))
        std::for_each(colours, result.runs.end(),
                      [&](CycleRun& run) { leave_untold(of_projectors, result.exposure_s, run); });
    result.unseen_hz = cycles_that_stand_still(of_lamps, result.frames_hz, lasted_s);
    result.lamps_may_hide = !result.unseen_hz.empty();
    for (const double hz : cycles_that_stand_still(of_projectors, result.frames_hz, lasted_s)) {
        result.wheel_may_hide = true;
        if (std::find(result.unseen_hz.begin(), result.unseen_hz.end(), hz) == result.unseen_hz.end())
            result.unseen_hz.push_back(hz);
    }
    std::sort(result.unseen_hz.begin(), result.unseen_hz.end());
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
    const std::vector<Visits> all = visits_of(recording, lit.tiles);
    const bool has_black = !all.empty() && all.front().colour == kBlack;
    if (!has_black || all.size() < 2) {
        result.refusal = {fmt::format("{} frames are missing for {}", kLeastFrames, has_black ? "white" : "black"),
                          "Let the cameras run while one picture stands still, for black and for white at least."};
        return result;
    }
    measure_runs(all, settings, result);
    result.room_varies = result.runs.front().varies;
    for (std::size_t i = 1; i < result.runs.size(); ++i) {
        const CycleRun& run = result.runs[i];
        if (!run.varies) continue;
        result.projector_varies = true;
        result.worst = std::max(result.worst, run.variation);
        result.worst_is_told = result.worst_is_told && run.size_is_told;
    }
    find_cure(settings, result);
    return result;
}

}  // namespace planlight
