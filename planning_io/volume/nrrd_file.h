#pragma once

#include <filesystem>

#include "planning_io/types/volume.h"

namespace planlight {

/// A NRRD volume (.nrrd, or .nhdr with its data file in the same folder), raw or gzip. `space` must be
/// left-posterior-superior, right-anterior-superior or left-anterior-superior, with directions and origin in mm;
/// InputError else. To be called in a child process.
Volume parse_nrrd(const std::filesystem::path& file);

}  // namespace planlight
