#pragma once

#include "app/doctor/judge_room.h"

namespace planlight {

/// What this computer says of itself: free disk at `folder`, OpenGL, governors of the processors.
MachineFigures examine_machine(const std::filesystem::path& folder);

/// net.core.rmem_max; empty where the system does not tell.
std::optional<std::size_t> receive_buffer_max();

}  // namespace planlight
