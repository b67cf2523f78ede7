#pragma once

#include "app/live/projector_options.h"

namespace planlight {

/// `planlight projector --identify`: lists the monitors, and shows each its own name for a while. Gives the exit code.
int identify_monitors(const ProjectorOptions& options);

}  // namespace planlight
