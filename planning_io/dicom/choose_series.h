#pragma once

#include "planning_io/dicom/dicom_folder.h"

namespace planlight {

/// The series of that UID or number; else that of `file`; else the only volume. Throws InputError with the list of
/// series when there is none or more than one, DamagedFileError when a damaged file of the folder is of the series.
DicomSeries choose_series(const DicomFolder& folder, const std::filesystem::path& path, const std::string& wanted);

}  // namespace planlight
