#pragma once

#include <filesystem>
#include <vector>

#include "planning_io/types/tracked_pose.h"

namespace planlight {

/// poses.json, as `track` writes it: one entry a frame, with or without a pose.
void write_poses(const std::vector<TrackedPose>& poses, const std::filesystem::path& file);
std::vector<TrackedPose> read_poses(const std::filesystem::path& file);

}  // namespace planlight
