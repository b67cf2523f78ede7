#pragma once

#include <filesystem>
#include <string>

#include "planning_io/types/volume.h"

namespace planlight {

/// Parses and checks the series in this process, which a damaged file may crash: `read_dicom_series` calls it in a child.
Volume parse_dicom_series(const std::filesystem::path& folder_or_file, const std::string& series_uid);

}  // namespace planlight
