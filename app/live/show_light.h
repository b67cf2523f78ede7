#pragma once

#include "app/live/projector_options.h"

namespace planlight {

/// `planlight projector --show`: the light of every part on a real projector, for cameras that Planlight does not
/// drive. Writes KEEP/PART/light.json with the orders and an empty list of frames, to be filled in. Gives the exit
/// code; dark on every way out.
int show_light(const ProjectorOptions& options);

}  // namespace planlight
