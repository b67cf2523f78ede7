#pragma once

#include <filesystem>

#include "planning_io/types/image.h"

namespace planlight::test {

/// Writes a binary PPM.
void write_picture(const std::filesystem::path& file, const RgbImage& picture);

/// Reads a binary PPM of 8 bit without comments.
RgbImage read_picture(const std::filesystem::path& file);

}  // namespace planlight::test
