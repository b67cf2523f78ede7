#pragma once

#include "registration/projector_measurement/record_light.h"
#include "registration/simulation/board_room.h"

namespace planlight::test {

/// Simulated room with a white card, and a bench on it; waiting passes the room's own time.
struct CardRoom {
    explicit CardRoom(const simulation::BoardRoomSettings& settings);
    simulation::SimulatedBoardRoom room;
    LightBench bench;
};

/// The truth of one recording: delays of the orders that were shown, seconds.
std::vector<double> true_delays_s(const LightRecording& recording, const std::vector<simulation::TrueLight>& truth);

}  // namespace planlight::test
