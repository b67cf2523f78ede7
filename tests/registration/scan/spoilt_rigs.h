#pragma once

#include <functional>
#include <string>
#include <vector>

#include "planning_io/types/rig_calibration.h"

namespace planlight::scan_rooms {

/// A calibration that is wrong on purpose.
struct SpoiltRig {
    std::string what;
    std::function<void(RigCalibration&)> spoil;
};

/// Nothing wrong, then one thing wrong at a time.
std::vector<SpoiltRig> spoilt_rigs();

}  // namespace planlight::scan_rooms
