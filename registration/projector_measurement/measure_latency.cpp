#include "registration/projector_measurement/measure_latency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "registration/projector_measurement/find_refreshes.h"
#include "registration/projector_measurement/fit_delays.h"
#include "registration/projector_measurement/judge_promise.h"

namespace planlight {
namespace {

constexpr double kStep_s = 0.0005;
constexpr double kLeastAgreement = 0.6;

/// The ordered changes, and the frames as shares of white.
struct Flashes {
    struct Change {
        double at_s = 0;
        bool to_white = false;
        std::size_t order = 0;
    };
    std::vector<Change> changes;
    struct Frame {
        double opened_s = 0, closed_s = 0, light = 0;  ///< light: 0 black, 1 white
    };
    std::vector<Frame> frames;
    double noise = 0;         ///< of `light`
    double shortest_s = 1e9;  ///< between two changes
};

bool is_white(const LightOrder& order) {
    return order.colour == Rgb{255, 255, 255};
}

Flashes flashes_of(const LightRecording& recording, const LitTiles& lit) {
    Flashes flashes;
    for (std::size_t o = 0; o < recording.orders.size(); ++o) {
        const bool white = is_white(recording.orders[o]);
        const bool before = !flashes.changes.empty() && flashes.changes.back().to_white;
        if (white == before) continue;
        const double at_s = seconds(recording.orders[o].at);
        if (!flashes.changes.empty())
            flashes.shortest_s = std::min(flashes.shortest_s, at_s - flashes.changes.back().at_s);
        flashes.changes.push_back({at_s, white, o});
    }
    for (const FrameBrightness& frame : recording.frames)
        flashes.frames.push_back({seconds(frame.opened()), seconds(frame.closed()),
                                  (mean_of(frame, lit.tiles) - lit.black) / (lit.white - lit.black)});
    flashes.noise = std::max(1e-3, lit.noise / (lit.white - lit.black));
    return flashes;
}

/// Share of [from, to] in which it is ordered to be white, were the light there at once. `hint`: where to look, moves
/// on.
double ordered_share(const std::vector<Flashes::Change>& changes, double from, double to, std::size_t& hint) {
    while (hint > 0 && changes[hint - 1].at_s > from) --hint;
    while (hint < changes.size() && changes[hint].at_s <= from) ++hint;
    bool white = hint > 0 && changes[hint - 1].to_white;
    double lit = 0, since = from;
    for (std::size_t i = hint; i < changes.size() && changes[i].at_s < to; ++i) {
        if (white) lit += changes[i].at_s - since;
        since = changes[i].at_s;
        white = changes[i].to_white;
    }
    if (white) lit += to - since;
    return to > from ? lit / (to - from) : (white ? 1 : 0);
}

/// Correlation of what was seen with what was ordered `delay_s` before.
double agreement(const Flashes& flashes, double delay_s) {
    double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
    std::size_t hint = 0;
    for (const auto& frame : flashes.frames) {
        const double x = ordered_share(flashes.changes, frame.opened_s - delay_s, frame.closed_s - delay_s, hint);
        sx += x, sy += frame.light, sxx += x * x, syy += frame.light * frame.light, sxy += x * frame.light;
    }
    const auto n = static_cast<double>(flashes.frames.size());
    const double spread = (sxx - sx * sx / n) * (syy - sy * sy / n);
    return spread > 0 ? (sxy - sx * sy / n) / std::sqrt(spread) : 0;
}

struct Search {
    double delay_s = 0, agreement = -1, runner_up = -1;
};

Search search(const Flashes& flashes, const LatencySettings& settings) {
    std::vector<std::pair<double, double>> all;
    for (double delay = settings.least_s; delay <= settings.most_s; delay += kStep_s)
        all.emplace_back(agreement(flashes, delay), delay);
    Search found;
    for (const auto& [value, delay] : all)
        if (value > found.agreement) found.agreement = value, found.delay_s = delay;
    // A flat top (the change falls between exposures): its middle.
    double low = found.delay_s, high = found.delay_s;
    for (const auto& [value, delay] : all)
        if (value > found.agreement - 1e-3 && std::abs(delay - found.delay_s) < flashes.shortest_s / 2)
            low = std::min(low, delay), high = std::max(high, delay);
    found.delay_s = (low + high) / 2;
    for (const auto& [value, delay] : all)
        if (std::abs(delay - found.delay_s) > flashes.shortest_s / 2)
            found.runner_up = std::max(found.runner_up, value);
    return found;
}

/// One change, looked for in the frames between the changes beside it; `seen` says whether its light came at all.
struct Seen {
    LightDelay delay;
    bool seen = false;
};

Seen look_for(const Flashes& flashes, std::size_t c, double delay_s) {
    const auto& change = flashes.changes[c];
    const double from = (c > 0 ? (flashes.changes[c - 1].at_s + change.at_s) / 2 : change.at_s - 0.2) + delay_s;
    const double to =
        (c + 1 < flashes.changes.size() ? (flashes.changes[c + 1].at_s + change.at_s) / 2 : change.at_s + 0.2) +
        delay_s;
    Seen seen;
    seen.delay.order = change.order;
    double at_least = -1e9, at_most = 1e9;
    // Light that is as unsteady as that says which of the two it is, but not what part of an exposure it was there.
    constexpr double kUnsteady = 0.1;
    const bool coarse = flashes.noise > kUnsteady;
    const double sure = coarse ? 0.5 : std::max(4 * flashes.noise, 0.02);
    bool old_before = false;
    for (const auto& frame : flashes.frames) {
        if (frame.opened_s < from || frame.closed_s > to) continue;
        const double share = change.to_white ? frame.light : 1 - frame.light;  // of the exposure in the new light
        if (share < sure) {
            at_least = std::max(at_least,
                                coarse ? frame.opened_s : frame.closed_s - share * (frame.closed_s - frame.opened_s));
            old_before = true;
        } else if (share >= 1 - sure) {
            at_most = std::min(at_most, coarse ? frame.closed_s : frame.opened_s);
        } else {
            at_least = at_most = frame.closed_s - share * (frame.closed_s - frame.opened_s);
            seen.delay.exact = true;
            break;
        }
    }
    seen.seen = at_most < 1e8 && (old_before || seen.delay.exact) && at_least <= at_most;
    seen.delay.at_least_s = at_least - change.at_s;
    seen.delay.at_most_s = at_most - change.at_s;
    return seen;
}

/// Changes whose old light is still there when even the latest would have come.
std::size_t unseen_changes(const Flashes& flashes, const LatencyResult& result) {
    constexpr double kSpare_s = 0.002, kOld = 0.2;
    std::size_t unseen = 0;
    for (std::size_t c = 1; c + 1 < flashes.changes.size(); ++c) {
        const auto& change = flashes.changes[c];
        const double from = change.at_s + result.latest_s + kSpare_s,
                     to = flashes.changes[c + 1].at_s + result.earliest_s - kSpare_s;
        unseen += std::any_of(flashes.frames.begin(), flashes.frames.end(), [&](const Flashes::Frame& frame) {
            return frame.opened_s >= from && frame.closed_s <= to &&
                   (change.to_white ? frame.light : 1 - frame.light) < kOld;
        });
    }
    return unseen;
}

/// Changes that come at refreshes only are known to the moment, also between two exposures.
void use_refreshes(const LightRecording& recording, double nominal_hz, double reading_s, LatencyResult& result) {
    std::vector<double> at_s;
    for (const LightDelay& delay : result.delays) at_s.push_back(seconds(recording.orders[delay.order].at));
    const auto refreshes = find_refreshes(result.delays, at_s, nominal_hz, reading_s);
    if (!refreshes) return;
    auto placed = at_refreshes(*refreshes, result.delays, at_s);
    if (!placed) return;
    result.delays = std::move(*placed);
    result.refresh_hz = refreshes->hz;
}

LatencyResult refused(LatencyResult result, std::string reason, std::string remedy) {
    result.refusal = {std::move(reason), std::move(remedy)};
    return result;
}

}  // namespace

LatencyResult measure_latency(const LightRecording& recording, const LatencySettings& settings) {
    LatencyResult result;
    const LitTiles lit = find_flashing_tiles(recording);
    if (lit.refusal) {
        result.refusal = lit.refusal;
        return result;
    }
    result.frames = frame_timing(recording);
    const Flashes flashes = flashes_of(recording, lit);
    result.changes = flashes.changes.size();
    constexpr std::size_t kLeastChanges = 12;
    if (result.changes < kLeastChanges)
        return refused(result,
                       fmt::format("only {} changes between black and white were ordered; {} are needed",
                                   result.changes, kLeastChanges),
                       "Record the whole flash code.");
    if (flashes.shortest_s < 1.9 * result.frames.interval_s)
        return refused(
            result,
            fmt::format(
                "the cameras are too slow for these flashes: the shortest is {:.0f} ms, a frame comes every {:.0f} ms",
                1e3 * flashes.shortest_s, 1e3 * result.frames.interval_s),
            "Flash two frames long at least, or raise the frame rate.");
    const Search found = search(flashes, settings);
    result.code_agreement = found.agreement;
    result.runner_up_agreement = found.runner_up;
    if (found.agreement < kLeastAgreement)
        return refused(
            result,
            fmt::format("what the cameras saw is not the code that was shown (agreement {:.2f})", found.agreement),
            "Check that the cameras' times and the orders' are on one clock, and that nobody walked through the "
            "light.");
    if (found.runner_up > 0.85 * found.agreement)
        return refused(
            result,
            fmt::format(
                "the flashes fit the frames at several delays (agreement {:.2f} and {:.2f}): they repeat themselves",
                found.agreement, found.runner_up),
            "Flash in a pseudo-random order, as `planlight projector` does.");
    for (std::size_t c = 1; c < flashes.changes.size(); ++c) {
        const Seen seen = look_for(flashes, c, found.delay_s);
        if (seen.seen) {
            result.delays.push_back(seen.delay);
            result.exact += seen.delay.exact;
        }
    }
    if (result.delays.size() < kLeastChanges / 2)
        return refused(
            result,
            fmt::format("only {} of {} changes of light are seen cleanly", result.delays.size(), result.changes),
            "Give the code more light or more frames a flash.");
    const Instant exposure = recording.frames.front().exposure;
    use_refreshes(recording, settings.refresh_hz, flashes.noise * seconds(exposure), result);
    fit_delays(flashes.noise, exposure, result);
    if (result.jitter_s > flashes.shortest_s / 4)
        return refused(
            result,
            fmt::format("the delays differ by {:.0f} ms (standard deviation), too much for flashes of {:.0f} ms",
                        1e3 * result.jitter_s, 1e3 * flashes.shortest_s),
            "See first whether the light is steady (the colour cycle), then flash longer.");
    if (result.median_s < -0.001)
        return refused(
            result, fmt::format("the light was seen {:.1f} ms before it was ordered", -1e3 * result.median_s),
            "The cameras' times are not on the orders' clock: correct their offset (in room.json a shorter "
            "\"transfer_ms\", where the cameras' link is faster than it was taken to be), then measure again.");
    result.unseen = unseen_changes(flashes, result);
    for (const LightDelay& delay : result.delays)
        result.late += delay.at_least_s > result.median_s + 0.75 / settings.refresh_hz;
    judge_promise(recording, result);
    return result;
}

}  // namespace planlight
