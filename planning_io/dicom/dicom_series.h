#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/dicom/slice_gaps.h"
#include "planning_io/types/series_identity.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// Parses and checks the series of that UID or number (or the only volume there) in this process, which a damaged file
/// may crash: to be called in a child process.
/// `unreadable`: files that are known to crash it. `identity`: told whose it is.
Volume parse_dicom_series(const std::filesystem::path& folder_or_file, const std::string& series,
                          SliceGaps gaps = SliceGaps::refused,
                          const std::vector<std::filesystem::path>& unreadable = {},
                          SeriesIdentity* identity = nullptr);

/// The files beside it, or below it, that would crash `parse_dicom_series` before it knows whose they are.
std::vector<std::filesystem::path> crashing_files_of(const std::filesystem::path& folder_or_file);

}  // namespace planlight
