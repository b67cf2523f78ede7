#pragma once

#include <filesystem>
#include <string>

#include "planning_io/dicom/slice_gaps.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// Parses and checks the series of that UID or number (or the only volume there) in this process, which a damaged file
/// may crash: to be called in a child process.
Volume parse_dicom_series(const std::filesystem::path& folder_or_file, const std::string& series,
                          SliceGaps gaps = SliceGaps::refused);

}  // namespace planlight
