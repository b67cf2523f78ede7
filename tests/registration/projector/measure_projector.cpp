// What `planlight projector` measures in simulated rooms, against their truth. measure_projector paper|modern [ROOMS]
// [PART] [v]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "registration/projector/light_findings.h"
#include "tests/registration/projector/card_room.h"

namespace planlight {
namespace {

void print(const std::string& what, std::vector<double> values, const std::string& unit) {
    if (values.empty()) return fmt::print("{:<52} none\n", what);
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) {
        return values[std::max<std::size_t>(
                          static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))), 1) -
                      1];
    };
    fmt::print("{:<52} {:3} rooms: {:8.4f} / {:8.4f} / {:8.4f} {}\n", what, values.size(), at(0.5), at(0.95),
               values.back(), unit);
    std::fflush(stdout);
}

struct Rooms {
    simulation::Preset preset;
    unsigned count;
    bool verbose;
    simulation::BoardRoomSettings settings(unsigned seed) const {
        simulation::BoardRoomSettings s;
        s.preset = preset;
        s.seed = seed;
        return s;
    }
};

struct Draw {
    std::mt19937 random;
    explicit Draw(unsigned seed) : random(seed * 7919U + 13U) {}
    double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
};

void measure_responses(const Rooms& rooms, bool unsteady) {
    std::vector<double> gamma, gamma_by_sigma, dark, bright, black, colour;
    unsigned refused = 0, false_dark = 0, false_bright = 0, missed_dark = 0, missed_bright = 0, crushed_dark = 0,
             crushed_bright = 0, other = 0;
    for (unsigned seed = 1; seed <= rooms.count; ++seed) {
        Draw draw(seed);
        auto s = rooms.settings(seed);
        auto& panel = s.light.panel;
        panel.gamma = draw.between(1.6, 2.8);
        panel.black = draw.between(0.5, 3) / 1000;
        if (seed % 2 == 0) panel.dark_end = draw.between(4, 24) / 255;
        if (seed % 3 == 0) panel.bright_end = 1 - draw.between(4, 24) / 255;
        panel.colours = {draw.between(0.2, 0.35), draw.between(0.4, 0.55), 0};
        panel.colours[2] = 1 - panel.colours[0] - panel.colours[1];
        s.ambient = draw.between(0.03, 0.2);
        if (unsteady) {
            s.light.wheel_hz = draw.between(59.5, 60.5) * (2 + static_cast<int>(seed % 3));
            s.light.mains_hz = 100;
            s.light.mains_depth = 0.2;
        }
        test::CardRoom card(s);
        LightRecording recording = record_response(card.bench);
        card.room.cover_projector(true);
        record_covered(card.bench, recording);
        const ResponseResult r = measure_response(recording);
        if (r.refusal) {
            ++refused;
            continue;
        }
        gamma.push_back(std::abs(r.gamma - panel.gamma));
        gamma_by_sigma.push_back(std::abs(r.gamma - panel.gamma) / r.gamma_sigma);
        dark.push_back(std::abs(r.dark_end - 255 * panel.dark_end));
        bright.push_back(std::abs(r.bright_end - 255 * panel.bright_end));
        black.push_back(1e3 * std::abs(r.black_level - panel.black));
        for (std::size_t c = 0; c < 3; ++c) colour.push_back(100 * std::abs((*r.colours)[c] - panel.colours[c]));
        (panel.dark_end > 0 ? crushed_dark : false_dark) += r.crushes_darks;
        (panel.bright_end < 1 ? crushed_bright : false_bright) += r.crushes_whites;
        missed_dark += panel.dark_end > 0 && !r.crushes_darks;
        missed_bright += panel.bright_end < 1 && !r.crushes_whites;
        for (const LightFinding& f : findings_of(r))
            other += f.what.find("crush") == std::string::npos && f.what.find("limited") == std::string::npos;
        if (rooms.verbose)
            fmt::print(
                "  seed {}: gamma {:.3f} found {:.3f} +- {:.3f}; ends {:.1f} {:.1f} found {:.1f}+-{:.1f} "
                "{:.1f}+-{:.1f}; black {:.5f} found {:.5f}\n",
                seed, panel.gamma, r.gamma, r.gamma_sigma, 255 * panel.dark_end, 255 * panel.bright_end, r.dark_end,
                r.dark_end_sigma, r.bright_end, r.bright_end_sigma, panel.black, r.black_level);
    }
    fmt::print(
        "response{}: {} refused; darks crushed noticed {}, missed {}, false {}; whites noticed {}, missed {}, false "
        "{}; other findings {}\n",
        unsteady ? " under a colour wheel of 2 to 4 turns a picture, lamps that flicker" : "", refused, crushed_dark,
        missed_dark, false_dark, crushed_bright, missed_bright, false_bright, other);
    print("gamma error", gamma, "");
    print("gamma error by its stated sigma", gamma_by_sigma, "");
    print("dark end error", dark, "grey");
    print("bright end error", bright, "grey");
    print("black level error, thousandths of white", black, "");
    print("colour strength error", colour, "% of white");
}

void measure_latencies(const Rooms& rooms) {
    std::vector<double> error, by_sigma, jitter, latest, width;
    unsigned refused = 0, covered = 0, unseen = 0, skipped = 0, rooms_with_skips = 0, lost = 0;
    for (unsigned seed = 1; seed <= rooms.count; ++seed) {
        Draw draw(seed + 1000);
        auto s = rooms.settings(seed);
        s.projector_delay = from_seconds(draw.between(0.005, 0.12));
        s.light.whole_exposure = true;
        s.light.untold_delay = from_seconds(draw.between(0, 0.05));
        if (seed % 2 == 0) s.light.jitter = from_seconds(draw.between(0.002, 0.016));
        if (seed % 3 == 0) s.light.refresh_hz = 60;
        if (seed % 4 == 0) s.light.skipped_orders = 0.03, ++rooms_with_skips;
        if (seed % 5 == 0) s.light.lost_frames = 0.02;
        test::CardRoom card(s);
        const LightRecording recording = record_latency(card.bench);
        const LatencyResult r = measure_latency(recording);
        if (r.refusal) {
            ++refused;
            fmt::print("  seed {} refused: {}\n", seed, r.refusal->reason);
            continue;
        }
        std::vector<double> truth = test::true_delays_s(recording, card.room.true_lights());
        double mean = 0, square = 0;
        for (const double d : truth) mean += d / static_cast<double>(truth.size());
        for (const double d : truth) square += (d - mean) * (d - mean);
        const double spread = std::sqrt(square / static_cast<double>(truth.size()));
        error.push_back(1e3 * std::abs(r.median_s - mean));
        by_sigma.push_back(std::abs(r.median_s - mean) / r.median_sigma_s);
        jitter.push_back(1e3 * std::abs(r.jitter_s - spread));
        const double worst = *std::max_element(truth.begin(), truth.end());
        latest.push_back(1e3 * std::max(0.0, worst - r.light_delay_s));
        width.push_back(1e3 * (r.light_delay_s - worst));
        covered += r.light_delay_s >= worst;
        unseen += static_cast<unsigned>(r.unseen);
        lost += static_cast<unsigned>(r.frames.lost);
        for (const LightOrder& o : recording.orders)
            for (const auto& light : card.room.true_lights()) skipped += light.asked == o.at && !light.shown;
        if (rooms.verbose)
            fmt::print(
                "  seed {}: {:.2f} ms found {:.2f} +- {:.2f}; jitter {:.2f} found {:.2f}; worst {:.2f} to set {:.1f}; "
                "exact {} of {}; agree {:.3f} {:.3f}\n",
                seed, 1e3 * mean, 1e3 * r.median_s, 1e3 * r.median_sigma_s, 1e3 * spread, 1e3 * r.jitter_s, 1e3 * worst,
                1e3 * r.light_delay_s, r.exact, r.changes, r.code_agreement, r.runner_up_agreement);
    }
    fmt::print(
        "latency: {} refused; delay to set covers every order in {} of {}; left out by the projector {} in {} rooms, "
        "noticed {}; frames lost {}\n",
        refused, covered, error.size(), skipped, rooms_with_skips, unseen, lost);
    print("latency error", error, "ms");
    print("latency error by its stated sigma", by_sigma, "");
    print("jitter error (standard deviation)", jitter, "ms");
    print("delay to set: beyond the worst order", width, "ms");
}

void measure_cycles(const Rooms& rooms, bool wheel, bool mains) {
    std::vector<double> wheel_error, room_error, at_most;
    unsigned refused = 0, noticed = 0, room_noticed = 0, told = 0, told_right = 0, blind = 0;
    for (unsigned seed = 1; seed <= rooms.count; ++seed) {
        Draw draw(seed + 2000);
        auto s = rooms.settings(seed);
        s.light.whole_exposure = true;
        const double refresh = draw.between(59.5, 60.5);
        s.ambient = draw.between(0.05, 0.25);
        s.brightness = 0.75;
        if (wheel) s.light.wheel_hz = refresh * (1 + static_cast<int>(seed % 4));
        if (mains)
            s.light.mains_hz = (seed % 2 == 0 ? 100 : 120) + draw.between(-0.1, 0.1),
            s.light.mains_depth = draw.between(0.1, 0.4);
        test::CardRoom card(s);
        const LightRecording recording = record_cycle(card.bench);
        CycleSettings settings;
        settings.refresh_hz = refresh;
        const CycleResult r = measure_cycle(recording, settings);
        if (r.refusal) {
            ++refused;
            continue;
        }
        noticed += r.projector_varies;
        room_noticed += r.room_varies;
        if (wheel) {
            // The truth: each frame's share of red light, over the frames of the red run.
            const auto steady = steady_frames(recording);
            for (std::size_t o = 0; o < recording.orders.size(); ++o) {
                const Rgb c = recording.orders[o].colour;
                const int which = c == Rgb{255, 0, 0} ? 0 : c == Rgb{0, 255, 0} ? 1 : c == Rgb{0, 0, 255} ? 2 : -1;
                if (which < 0 || steady[o].empty()) continue;
                double sum = 0, square = 0;
                for (const std::size_t f : steady[o]) {
                    const double v =
                        simulation::wheel_during(s.light, recording.frames[f].opened(),
                                                 recording.frames[f].closed())[static_cast<std::size_t>(which)];
                    sum += v, square += v * v;
                }
                const auto n = static_cast<double>(steady[o].size());
                const double spread = std::sqrt(std::max(0.0, square / n - sum / n * sum / n)) / (sum / n);
                for (const CycleRun& run : r.runs)
                    if (run.name == (which == 0 ? "red" : which == 1 ? "green" : "blue")) {
                        wheel_error.push_back(100 * std::abs(run.variation - spread));
                        if (which == 0) blind += spread < 0.005;
                        if (rooms.verbose)
                            fmt::print("  seed {} {}: {:.2f} % found {:.2f} +- {:.2f} {}\n", seed, run.name,
                                       100 * spread, 100 * run.variation, 100 * run.variation_sigma,
                                       run.varies ? "varies" : "steady");
                        if (which == 0 && run.varies && run.cycles_hz.size() == 1)
                            ++told, told_right += std::abs(run.cycles_hz[0] - s.light.wheel_hz) < 1;
                    }
            }
        }
        for (std::size_t i = 1; i < r.runs.size(); ++i) at_most.push_back(100 * r.runs[i].at_most);
        if (mains) {
            const auto steady = steady_frames(recording);
            double sum = 0, square = 0;
            for (const std::size_t f : steady[0]) {
                const double v =
                    simulation::lamps_during(s.light, recording.frames[f].opened(), recording.frames[f].closed());
                sum += v, square += v * v;
            }
            const auto n = static_cast<double>(steady[0].size());
            const double spread = std::sqrt(std::max(0.0, square / n - sum / n * sum / n)) / (sum / n);
            room_error.push_back(100 * std::abs(r.runs[0].variation - spread));
            if (rooms.verbose)
                fmt::print("  seed {} room: {:.2f} % found {:.2f} {}\n", seed, 100 * spread, 100 * r.runs[0].variation,
                           r.runs[0].varies);
        }
    }
    fmt::print(
        "cycle ({}, {}): {} refused; projector said to vary in {} of {} rooms{}; room's lamps in {}; cycle told in {}, "
        "rightly in {}\n",
        wheel ? "colour wheel" : "no wheel", mains ? "mains flicker" : "steady lamps", refused, noticed, rooms.count,
        wheel ? fmt::format(" (in {} red truly varies under 0.5 %)", blind) : "", room_noticed, told, told_right);
    if (wheel) print("variation of a pure colour, error", wheel_error, "% of its light");
    if (mains) print("variation of the lamps, error", room_error, "% of their light");
    print("95 % bound of the projector's variation", at_most, "%");
}

}  // namespace
}  // namespace planlight

int main(int argc, char** argv) {
    using namespace planlight;
    const std::string preset = argc > 1 ? argv[1] : "paper", part = argc > 3 ? argv[3] : "all";
    const Rooms rooms{preset == "modern" ? simulation::Preset::modern : simulation::Preset::paper,
                      argc > 2 ? static_cast<unsigned>(std::stoi(argv[2])) : 20, argc > 4};
    const auto wanted = [&](const std::string& name) { return part == "all" || part == name; };
    if (wanted("response")) measure_responses(rooms, false);
    if (wanted("response-unsteady")) measure_responses(rooms, true);
    if (wanted("latency")) measure_latencies(rooms);
    if (wanted("cycle-none")) measure_cycles(rooms, false, false);
    if (wanted("cycle-lamps")) measure_cycles(rooms, false, true);
    if (wanted("cycle")) measure_cycles(rooms, true, true);
    return 0;
}
