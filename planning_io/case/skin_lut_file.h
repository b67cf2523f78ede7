#pragma once

#include <filesystem>

#include "planning_io/types/skin_lut.h"

namespace planlight {

/// The LUT file (format in the room's README): header with version, endianness, geometry, hashes of volume and mesh,
/// and zstd chunks with XXH3-128 checksums.
void write_skin_lut(const SkinLut& lut, const std::filesystem::path& file);

/// Every chunk is verified. Throws DamagedFileError for a flipped bit, a truncation, another version or endianness.
SkinLut read_skin_lut(const std::filesystem::path& file);

}  // namespace planlight
