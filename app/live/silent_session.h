#pragma once

#include "app/windows/operator_model.h"
#include "planning_io/types/time.h"

namespace planlight {

/// The light of a session whose thread hangs expires by itself, and its last words stay: green over darkness. Where
/// light was on the patient (`projecting`) and the session has been `silent` for longer than `patience`, the model says
/// that it is dark, and why; nothing of the light that was measured is left in it. What says that pictures are taken
/// stays: of these the session computes for longer.
void say_silence(OperatorModel& model, bool projecting, Instant silent, Instant patience);

}  // namespace planlight
