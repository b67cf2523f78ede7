#pragma once

#include <filesystem>
#include <string>

#include "planning_io/types/volume.h"

namespace planlight {

/// The volume of one DICOM series, from a folder of slices (or any file in it), parsed in a child process with limits
/// (4 GiB of memory, 60 s): a crash of the parser is a DamagedFileError. What is refused stands in the room's README.
///
/// Gantry tilt is kept as a sheared affine; slices stand in the order that makes `ct_from_voxel` right-handed.
Volume read_dicom_series(const std::filesystem::path& folder_or_file, const std::string& series_uid);

}  // namespace planlight
