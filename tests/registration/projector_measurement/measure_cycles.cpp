#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "registration/projector_measurement/measure_cycle.h"
#include "tests/registration/projector_measurement/card_room.h"
#include "tests/registration/projector_measurement/measured_rooms.h"
#include "tests/registration/projector_measurement/tile_room.h"

namespace planlight::test {

namespace {

/// What is true of a room.
struct CycleTruth {
    double wheel_hz = 0, lamps_hz = 0, lamps_depth = 0, refresh_hz = 60;
    std::array<double, 3> colours{};

    double of_lamps(double exposure_s) const {
        const double turn = M_PI * lamps_hz * exposure_s;
        return turn > 0 ? lamps_depth * std::abs(std::sin(turn) / turn) / std::sqrt(2.0) : 0;
    }
    double of(const std::string& picture, double exposure_s) const {
        if (picture == "black") return of_lamps(exposure_s);
        if (wheel_hz <= 0) return 0;
        std::array<double, 3> shares{};
        if (picture == "white") shares = colours;
        if (picture == "red") shares[0] = 1;
        if (picture == "green") shares[1] = 1;
        if (picture == "blue") shares[2] = 1;
        return wheel_variation(wheel_hz * exposure_s, shares);
    }
};

/// Sizes that were stated, against the truth.
struct Sizes {
    std::vector<double> error, by_sigma, untold_error;
    unsigned within_two_sigmas = 0, untold = 0, bounds = 0, covered = 0;

    void add(const CycleRun& run, double truth) {
        const double off = std::abs(run.variation - truth);
        ++bounds;
        covered += truth <= run.at_most;
        if (!run.varies) return;
        if (!run.size_is_told) return ++untold, untold_error.push_back(100 * off), void();
        error.push_back(100 * off);
        by_sigma.push_back(off / run.variation_sigma);
        within_two_sigmas += off <= 2 * run.variation_sigma;
    }
    void tell(const std::string& what) const {
        print(what + ", error where its size is told", error, "% of its light");
        print(what + ", the same by its stated sigma", by_sigma, "");
        fmt::print("{}: told {}, within two sigmas {}; said that it cannot be told {}; bound covers {} of {}\n", what,
                   error.size(), within_two_sigmas, untold, covered, bounds);
        print(what + ", what was met, off, where not told", untold_error, "% of its light");
    }
};

struct Tally {
    Sizes wheel, lamps;
    std::vector<double> at_most, cured;
    unsigned rooms = 0, refused = 0, noticed = 0, room_noticed = 0, steady_truth = 0;
    unsigned told = 0, right = 0, told_roughly = 0, right_roughly = 0, cures = 0;

    void add(const LightRecording& recording, const CycleTruth& truth, double roughly_hz, bool verbose, unsigned seed) {
        ++rooms;
        CycleSettings settings;
        settings.refresh_hz = truth.refresh_hz;
        settings.refresh_tolerance_hz = 0.003;  // 50 ppm: two clocks
        const CycleResult r = measure_cycle(recording, settings);
        settings.refresh_hz = roughly_hz;
        settings.refresh_tolerance_hz = 0.1;
        const CycleResult rough = measure_cycle(recording, settings);
        if (r.refusal) return ++refused, void();
        noticed += r.projector_varies, room_noticed += r.room_varies;
        lamps.add(r.runs.front(), truth.of("black", r.exposure_s));
        double worst_truth = 0;
        for (std::size_t i = 1; i < r.runs.size(); ++i) {
            const double is = truth.of(r.runs[i].name, r.exposure_s);
            worst_truth = std::max(worst_truth, is);
            wheel.add(r.runs[i], is);
            at_most.push_back(100 * r.runs[i].at_most);
        }
        steady_truth += worst_truth < settings.noticed;
        name_cycle(r, truth, told, right);
        name_cycle(rough, truth, told_roughly, right_roughly);
        if (rough.projector_varies && rough.exposure_to_set_s > 0) {
            double left = 0;
            for (const char* colour : {"white", "red", "green", "blue"})
                left = std::max(left, truth.of(colour, rough.exposure_to_set_s));
            cured.push_back(100 * left), ++cures;
        }
        if (verbose) tell_runs(r, truth, seed);
    }
    static void name_cycle(const CycleResult& r, const CycleTruth& truth, unsigned& told, unsigned& right) {
        for (std::size_t i = 1; i < r.runs.size(); ++i)
            if (r.runs[i].varies && r.runs[i].cycles_hz.size() == 1) {
                ++told, right += std::abs(r.runs[i].cycles_hz[0] - truth.wheel_hz) < 1;
                return;
            }
    }
    static void tell_runs(const CycleResult& r, const CycleTruth& truth, unsigned seed) {
        for (const CycleRun& run : r.runs) {
            fmt::print(
                "  seed {:3} {:6} wheel {:.3f} refresh {:.3f} lamps {:.3f}: {:.2f} % found {:.2f} +- {:.2f} at most "
                "{:.1f} {}{}; seen at {:.3f} Hz, may be",
                seed, run.name, truth.wheel_hz, truth.refresh_hz, truth.lamps_hz,
                100 * truth.of(run.name, r.exposure_s), 100 * run.variation, 100 * run.variation_sigma,
                100 * run.at_most, run.varies ? "varies" : "steady", run.size_is_told ? "" : ", size not told",
                run.seen_hz.value_or(-1));
            for (const double hz : run.cycles_hz) fmt::print(" {:.1f}", hz);
            fmt::print("\n");
        }
    }
    void tell(const std::string& what, bool with_wheel, bool with_lamps) const {
        fmt::print("{}: {} rooms, {} refused; projector said to vary in {}{}; lamps in {}\n", what, rooms, refused,
                   noticed, with_wheel ? fmt::format(" (truly under 0.5 % in {})", steady_truth) : "", room_noticed);
        if (with_wheel) {
            wheel.tell("colour");
            fmt::print("cycle told as one in {}, rightly in {}; with the refresh known to 0.1 Hz only: {}, {}\n", told,
                       right, told_roughly, right_roughly);
            print("a colour's variation at the exposure to set", cured, "% of its light");
        } else {
            print("95 % bound of the projector's variation", at_most, "%");
        }
        if (with_lamps) lamps.tell("lamps");
    }
};

std::string words(bool wheel, bool mains) {
    return fmt::format("cycle ({}, {})", wheel ? "colour wheel" : "no wheel", mains ? "mains flicker" : "steady lamps");
}

}  // namespace

void measure_cycles(const Rooms& rooms, bool wheel, bool mains) {
    Tally tally;
    for (unsigned seed = rooms.first; seed < rooms.first + rooms.count; ++seed) {
        Draw draw(seed + 2000);
        auto s = rooms.settings(seed);
        s.light.whole_exposure = true;
        CycleTruth truth;
        truth.refresh_hz = draw.between(59.5, 60.5);
        s.ambient = draw.between(0.05, 0.25);
        s.brightness = 0.75;
        if (wheel) truth.wheel_hz = s.light.wheel_hz = truth.refresh_hz * (1 + static_cast<int>(seed % 4));
        if (mains) {
            truth.lamps_hz = s.light.mains_hz = (seed % 2 == 0 ? 100 : 120) + draw.between(-0.1, 0.1);
            truth.lamps_depth = s.light.mains_depth = draw.between(0.1, 0.4);
        }
        truth.colours = s.light.panel.colours;
        const double roughly_hz = truth.refresh_hz + draw.between(-0.1, 0.1);
        CardRoom card(s);
        tally.add(record_cycle(card.bench), truth, roughly_hz, rooms.verbose, seed);
    }
    tally.tell(words(wheel, mains), wheel, mains);
}

void measure_many_cycles(const Rooms& rooms) {
    for (const bool wheel : {false, true})
        for (const bool mains : {false, true}) {
            Tally tally;
            for (unsigned seed = rooms.first; seed < rooms.first + rooms.count; ++seed) {
                Draw draw(seed + 3000);
                CycleTruth truth;
                TileRoomSettings s;
                s.seed = seed;
                s.frames_hz = rooms.preset == simulation::Preset::modern ? 60 : 25;
                s.first_frame_s = draw.between(0, 0.1);
                s.wheel_phase = draw.between(0, 1);
                truth.refresh_hz = draw.between(59.5, 60.5);
                if (wheel) truth.wheel_hz = s.wheel_hz = truth.refresh_hz * (1 + static_cast<int>(seed % 4));
                if (mains) {
                    truth.lamps_hz = s.lamps_hz = (seed / 4 % 2 == 0 ? 100 : 120) + draw.between(-0.2, 0.2);
                    truth.lamps_depth = s.lamps_depth = draw.between(0.1, 0.4);
                }
                truth.colours = s.colours;
                const double roughly_hz = truth.refresh_hz + draw.between(-0.1, 0.1);
                TileRoom room(s);
                RecordSettings record;
                record.seed = seed;
                tally.add(record_cycle(room.bench(), record), truth, roughly_hz, rooms.verbose, seed);
            }
            tally.tell(words(wheel, mains), wheel, mains);
        }
}

}  // namespace planlight::test
