#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/case/capture_folder.h"

namespace planlight {

/// The pose folders of a calibration's captures, by name. Throws InputError when there are none.
std::vector<std::filesystem::path> pose_folders(const std::filesystem::path& captures);

/// The coded light of a pose: POSE/capture.json, else the one of all poses beside the pose folders; empty: plain
/// pictures.
std::optional<CaptureFolder> pose_settings(const std::filesystem::path& pose);

/// The pictures of coded light that a pose lacks, of either camera that has any: "POSE/left/NAME".
std::vector<std::string> missing_pictures(const std::filesystem::path& pose, const std::vector<std::string>& names);

/// The pictures of one pose in the order of `names` (of coded light), or one picture of each camera when `names` is
/// empty.
struct PosePictures {
    std::vector<GrayImage> left, right;  ///< right empty: no right camera
};

/// POSE/left/NAME.EXT and POSE/right/NAME.EXT, or POSE/left.EXT and POSE/right.EXT without coded light; EXT: png, tif,
/// tiff, jpg, bmp. A missing right camera is no error, a missing picture of a camera is one. Throws InputError.
PosePictures read_pose(const std::filesystem::path& pose, const std::vector<std::string>& names);

}  // namespace planlight
