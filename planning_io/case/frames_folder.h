#pragma once

#include <filesystem>
#include <vector>

#include "planning_io/types/stereo_frame.h"

namespace planlight {

/// A recorded run of stereo frames for tracking: frames.json (times, numbers) and left/NNNNNN.png, right/NNNNNN.png.
void write_frames(const std::vector<StereoFrame>& frames, const std::filesystem::path& folder);

/// In the order of their times, all of one size. Throws InputError or DamagedFileError with the file's name.
std::vector<StereoFrame> read_frames(const std::filesystem::path& folder);

}  // namespace planlight
