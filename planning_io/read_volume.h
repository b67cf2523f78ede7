#pragma once

#include <filesystem>
#include <string>

#include "planning_io/types/volume.h"

namespace planlight {

/// Reads a CT or MR volume: an InVesalius project (.inv3) or a folder (or any file) of a DICOM series.
///
/// DICOM is parsed in a child process with limits. Throws InputError for a series that is not one safe volume (missing or
/// double slice, uneven spacing, two series without `series_uid` ...), DamagedFileError for a damaged file.
Volume read_volume(const std::filesystem::path& path, const std::string& series_uid = {});

/// The hash of values and geometry (XXH3-128, hex): two volumes with the same hash are the same volume.
std::string hash_of(const Volume& volume);

}  // namespace planlight
