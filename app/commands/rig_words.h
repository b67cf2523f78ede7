#pragma once

#include <nlohmann/json_fwd.hpp>

#include "planning_io/types/rig_state.h"

namespace planlight {

/// What a scan found of the rig, for `--json`: verdict, sentence, remedy, hidden_light_mm, and of every device what is known.
nlohmann::ordered_json json_of(const RigState& state);

}  // namespace planlight
