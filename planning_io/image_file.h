#pragma once

#include <filesystem>

#include "planning_io/types/image.h"

namespace planlight {

/// PNG, written whole or not at all.
void write_png(const GrayImage& picture, const std::filesystem::path& file);
void write_png(const RgbImage& picture, const std::filesystem::path& file);

/// PNG or TIFF, 8 or 16 bit, grey or colour (converted to grey by luma). Throws DamagedFileError.
GrayImage read_gray(const std::filesystem::path& file);
RgbImage read_rgb(const std::filesystem::path& file);

}  // namespace planlight
