#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "planning_io/types/rig_state.h"
#include "planning_io/types/tracked_pose.h"

namespace planlight {

/// What poses were measured with.
struct PosesOrigin {
    RigName calibrated;        ///< rig.json
    std::string capture_hash;  ///< of the scan whose markers are the reference; empty: the first frame is
    RigCalibration rig;        ///< the cameras as they were used; the projector is not
};

/// poses.json, as `track` writes it: one entry a frame, with or without a pose.
void write_poses(const std::vector<TrackedPose>& poses, const std::filesystem::path& file,
                 const std::optional<PosesOrigin>& origin = {});

/// In the file's order; a frame without a pose is there with its reason. Throws InputError or DamagedFileError, which
/// also refuses a file with an origin that was changed since it was written.
std::vector<TrackedPose> read_poses(const std::filesystem::path& file);

/// What the file says of its origin; empty when it says nothing.
std::optional<PosesOrigin> read_poses_origin(const std::filesystem::path& file);

}  // namespace planlight
