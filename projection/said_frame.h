#pragma once

#include <string>

#include "planning_io/plan/plan_import.h"
#include "projection/skin_surface.h"

namespace planlight {

/// A warning where few points, too few for `check_plan` to tell a turned plan by, lie off the skin in the frame that
/// only a person said, and on it in the other of LPS and RAS; else empty.
std::string doubt_of_said_frame(const SaidFrame& said, const SkinSurface& skin);

}  // namespace planlight
