#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/live/guided_calibration.h"
#include "registration/simulation/board_room.h"
#include "tests/app/rig_error.h"

namespace planlight::test {

/// A guided calibration in a simulated room, without a wire, of a board that a person carries about.
struct GuidedRoom {
    std::size_t poses = 0;
    double took_s = 0;                   ///< by the room's clock
    std::map<std::string, int> refused;  ///< boards at rest that were sent on, by the reason in few words
    bool every_reason_said = true;
    std::optional<double> predicted_mm;
    Calibration calibration;
    RigError error;  ///< empty where the calibration is refused
};

GuidedRoom guide_in_room(simulation::Preset preset, unsigned seed, const PoseGuideSettings& settings = {});

}  // namespace planlight::test
