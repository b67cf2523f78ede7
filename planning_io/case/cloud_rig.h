#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/rig_state.h"

namespace planlight {

/// The rig that a cloud was made with, as comment lines of its PLY file (`write_cloud`): compact JSON with a checksum,
/// cut into lines that any reader of PLY takes.
std::vector<std::string> comments_of(const RigState& state);

/// Back from the comments of a PLY file. Empty when they say nothing of a rig (the cloud of another program); throws
/// DamagedFileError when a line is missing or was changed.
std::optional<RigState> rig_state_in(const std::vector<std::string>& comments, const std::filesystem::path& file);

}  // namespace planlight
