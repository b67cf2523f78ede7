#pragma once

#include <filesystem>

#include "planning_io/types/volume.h"

namespace planlight {

/// A NIfTI-1 volume (.nii, .nii.gz, one file), its RAS millimetres turned into ct (LPS). The frame is the sform's or
/// the qform's (nifti1.h, methods 3 and 2); InputError when the file names neither, or names two that differ. To be
/// called in a child process.
Volume parse_nifti(const std::filesystem::path& file);

}  // namespace planlight
