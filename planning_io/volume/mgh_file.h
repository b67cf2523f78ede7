#pragma once

#include <filesystem>

#include "planning_io/types/volume.h"

namespace planlight {

/// A FreeSurfer volume (.mgh, or .mgz packed by gzip), its RAS millimetres turned into ct (LPS). Version 1, one frame,
/// voxels of uint8, int16, int32 or float; InputError for one that does not say its axes ("good RAS" is 0), or that a
/// program made which takes faces away. To be called in a child process.
///
/// Format: FreeSurfer wiki, FsTutorial/MghFormat: big-endian, 284 bytes, voxels, then scan parameters and tags, of
/// which the command lines are looked at.
Volume parse_mgh(const std::filesystem::path& file);

}  // namespace planlight
