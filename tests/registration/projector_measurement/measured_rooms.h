#pragma once

#include <random>
#include <string>
#include <vector>

#include "registration/simulation/board_room.h"

namespace planlight::test {

/// Median, 95 % and worst of some rooms.
void print(const std::string& what, std::vector<double> values, const std::string& unit);

/// Which rooms are measured: seeds `first` to `first` + `count` - 1.
struct Rooms {
    simulation::Preset preset;
    unsigned count, first;
    bool verbose;
    simulation::BoardRoomSettings settings(unsigned seed) const {
        simulation::BoardRoomSettings s;
        s.preset = preset;
        s.seed = seed;
        return s;
    }
};

/// A room's own settings, from its seed.
struct Draw {
    std::mt19937 random;
    explicit Draw(unsigned seed) : random(seed * 7919U + 13U) {}
    double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
};

/// Colour wheels and lamps in simulated rooms.
void measure_cycles(const Rooms& rooms, bool wheel, bool mains);

/// Wheels and lamps in rooms by formula (`TileRoom`), hundreds of them: the coverage of what is stated.
void measure_many_cycles(const Rooms& rooms);

/// Latency in rooms by formula whose projector changes in step with the cameras, nearly so, or as it likes.
void measure_many_latencies(const Rooms& rooms);

}  // namespace planlight::test
