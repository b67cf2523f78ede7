// What `planlight projector` measures in simulated rooms, against their truth.
// measure_projector paper|modern [ROOMS] [PART] [FIRST SEED] [v]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "registration/projector_measurement/light_findings.h"
#include "tests/registration/projector_measurement/card_room.h"
#include "tests/registration/projector_measurement/measured_rooms.h"

namespace planlight {
namespace {

using test::Draw;
using test::print;
using test::Rooms;

void measure_responses(const Rooms& rooms, bool unsteady) {
    std::vector<double> gamma, gamma_by_sigma, dark, bright, black, colour;
    unsigned refused = 0, false_dark = 0, false_bright = 0, missed_dark = 0, missed_bright = 0, crushed_dark = 0,
             crushed_bright = 0, other = 0;
    for (unsigned seed = rooms.first; seed < rooms.first + rooms.count; ++seed) {
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
    for (unsigned seed = rooms.first; seed < rooms.first + rooms.count; ++seed) {
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

}  // namespace
}  // namespace planlight

int main(int argc, char** argv) {
    using namespace planlight;
    std::setvbuf(stdout, nullptr, _IOLBF, 0);  // a room takes its time: each is told at once
    const std::string preset = argc > 1 ? argv[1] : "paper", part = argc > 3 ? argv[3] : "all";
    const auto number = [&](int i, int otherwise) {
        return static_cast<unsigned>(argc > i ? std::stoi(argv[i]) : otherwise);
    };
    const Rooms rooms{preset == "modern" ? simulation::Preset::modern : simulation::Preset::paper, number(2, 20),
                      number(4, 1), argc > 5};
    const auto wanted = [&](const std::string& name) { return part == "all" || part == name; };
    if (wanted("response")) measure_responses(rooms, false);
    if (wanted("response-unsteady")) measure_responses(rooms, true);
    if (wanted("latency")) measure_latencies(rooms);
    if (wanted("cycle-none")) test::measure_cycles(rooms, false, false);
    if (wanted("cycle-lamps")) test::measure_cycles(rooms, false, true);
    if (wanted("cycle")) test::measure_cycles(rooms, true, true);
    if (part == "cycle-many") test::measure_many_cycles(rooms);
    if (part == "latency-many") test::measure_many_latencies(rooms);
    return 0;
}
