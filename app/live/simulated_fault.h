#pragma once

#include <string>
#include <vector>

#include "registration/simulation/simulated_rig.h"

namespace planlight {

/// Faults that a live session in the simulated room can be shown: to learn what each looks like.
const std::vector<std::string>& simulated_faults();

/// Lets that fault begin now: a device turned by 0.08 degrees, one marker or all of them slipped, a late picture, a lid
/// before the projector, a projector that holds its picture. Another word does nothing.
void begin_fault(const std::string& fault, simulation::SimulatedRig& rig);

}  // namespace planlight
