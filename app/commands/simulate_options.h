#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "registration/simulation/board_room.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight {

/// What `planlight simulate` was asked for; lengths in mm.
struct SimulateOptions {
    std::filesystem::path volume, plan, out;
    std::string series_uid, frame, accept_frame;  ///< of the volume; of a plan that does not say its coordinate system
    std::string board;                            ///< captures of a calibration board instead of a patient
    int poses = 15;
    std::string preset = "modern";
    unsigned seed = 1;
    int frames = 20;
    double speed_mm_s = 20;
    std::vector<std::string> with;  ///< drapes, hair, hand, instruments: names of kThings
    double hole_mm = 130;           ///< of the drape with a hole
    double wet = 0;                 ///< skin, 0 to 1
    std::string serve;  ///< monitor whose picture is the light: the room is served as hardware; empty: written to files
    std::vector<std::string> addresses{"127.0.0.1", "127.0.0.2"};  ///< of the served cameras
    double lose_packets = 0;                                       ///< share of the left served camera's
    double projector_delay_ms = 25;                                ///< from the order of a picture to its light
    int right_behind = 0;                                          ///< frames that the right served camera is behind
    bool json = false;
};
/// With `serve` given: two GigE Vision cameras and that monitor, until it is ended.
int run_simulate_served(const SimulateOptions& options, simulation::SimulatedRig& rig);
/// The same with a board that a person carries about.
int run_simulate_served_board(const SimulateOptions& options, simulation::SimulatedBoardRoom& room);
int run_simulate_board(const SimulateOptions& options);  ///< with `board` given

}  // namespace planlight
