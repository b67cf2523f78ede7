#pragma once

#include <functional>
#include <vector>

#include "registration/calibration/observe_pose.h"
#include "registration/simulation/board_room.h"

namespace planlight::test {

/// The sheet that a printer makes of the product's drawing.
simulation::BoardSheet printed(const BoardSpec& board);

/// The coded light of a room's projector.
StripeSettings stripes_of(const simulation::SimulatedBoardRoom& room);

/// What the product sees of every pose of a simulated room. `before(pose)` and `during(pose, picture)` may disturb it.
std::vector<PoseObservation> observe_room(simulation::SimulatedBoardRoom& room, const BoardSpec& board,
                                          const std::function<void(int)>& before = {},
                                          const std::function<void(int, int)>& during = {});

}  // namespace planlight::test
