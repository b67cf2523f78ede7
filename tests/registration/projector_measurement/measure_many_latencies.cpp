#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "registration/projector_measurement/measure_latency.h"
#include "tests/registration/projector_measurement/measured_rooms.h"
#include "tests/registration/projector_measurement/tile_room.h"

namespace planlight::test {
namespace {

enum class Refresh { none, in_step, nearly, other };

double refresh_hz(Refresh kind, double frames_hz, Draw& draw) {
    switch (kind) {
        case Refresh::none:
            return 0;
        case Refresh::in_step:
            return frames_hz == 25 ? 50 : frames_hz;
        case Refresh::nearly:
            return (frames_hz == 25 ? 50 : frames_hz) + draw.between(-0.1, 0.1);
        case Refresh::other:
            return draw.between(47, 75);
    }
    return 0;
}

void measure(const Rooms& rooms, Refresh kind, const std::string& what) {
    std::vector<double> error, by_sigma, beyond;
    unsigned refused = 0, covered = 0, in_step = 0, within_two_sigmas = 0;
    for (unsigned seed = rooms.first; seed < rooms.first + rooms.count; ++seed) {
        Draw draw(seed + 4000);
        TileRoomSettings s;
        s.seed = seed;
        s.frames_hz = rooms.preset == simulation::Preset::modern ? 60 : 25;
        s.first_frame_s = draw.between(0, 0.1);
        s.delay_s = draw.between(0.01, 0.17);
        s.refresh_hz = refresh_hz(kind, s.frames_hz, draw);
        s.refresh_phase = draw.between(0, 1);
        if (seed % 2 == 0) s.jitter_s = draw.between(0.002, 0.016);
        TileRoom room(s);
        RecordSettings record;
        record.seed = seed;
        LatencySettings settings;
        settings.refresh_hz = s.frames_hz == 25 ? 50 : 60;
        const LatencyResult r = measure_latency(record_latency(room.bench(), record), settings);
        if (r.refusal) {
            ++refused;
            if (rooms.verbose) fmt::print("  seed {} refused: {}\n", seed, r.refusal->reason);
            continue;
        }
        std::vector<double> truth = room.true_delays_s();
        truth.pop_back();  // the darkness at the end is not looked for
        double mean = 0;
        for (const double d : truth) mean += d / static_cast<double>(truth.size());
        const double off = std::abs(r.median_s - mean), worst = *std::max_element(truth.begin(), truth.end());
        error.push_back(1e3 * off);
        by_sigma.push_back(off / r.median_sigma_s);
        within_two_sigmas += off <= 2 * r.median_sigma_s;
        covered += r.light_delay_s >= worst;
        beyond.push_back(1e3 * (r.light_delay_s - worst));
        in_step += r.blind_s > 0;
        if (rooms.verbose)
            fmt::print(
                "  seed {}: {:.2f} ms found {:.2f} +- {:.2f}; worst {:.2f} to set {:.1f}; exact {} of {}; jitter "
                "{:.2f}; refresh {:.3f} found {:.3f}; blind {:.1f}\n",
                seed, 1e3 * mean, 1e3 * r.median_s, 1e3 * r.median_sigma_s, 1e3 * worst, 1e3 * r.light_delay_s, r.exact,
                r.delays.size(), 1e3 * s.jitter_s, s.refresh_hz, r.refresh_hz, 1e3 * r.blind_s);
    }
    fmt::print(
        "latency, {}: {} refused; within two sigmas {} of {}; delay to set covers every order in {}; said to be in "
        "step {}\n",
        what, refused, within_two_sigmas, error.size(), covered, in_step);
    print("latency error", error, "ms");
    print("latency error by its stated sigma", by_sigma, "");
    print("delay to set: beyond the worst order", beyond, "ms");
}

}  // namespace

void measure_many_latencies(const Rooms& rooms) {
    measure(rooms, Refresh::none, "no refresh");
    measure(rooms, Refresh::in_step, "refresh in step with the cameras");
    measure(rooms, Refresh::nearly, "refresh within 0.1 Hz of the cameras");
    measure(rooms, Refresh::other, "refresh of 47 to 75 Hz");
}

}  // namespace planlight::test
