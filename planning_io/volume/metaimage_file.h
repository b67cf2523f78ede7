#pragma once

#include <filesystem>

#include "planning_io/types/volume.h"

namespace planlight {

/// A MetaImage volume (.mha, or .mhd with its data file in the same folder), raw or zlib. Its physical space is ITK's,
/// which is LPS; InputError when the file says no frame, or an AnatomicalOrientation that its TransformMatrix does not
/// have. To be called in a child process.
Volume parse_metaimage(const std::filesystem::path& file);

}  // namespace planlight
