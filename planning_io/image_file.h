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

/// All pictures of a camera have one size: throws InputError when this one is not as large as the first.
void check_same_size(const GrayImage& picture, const GrayImage& first, const std::filesystem::path& file);

}  // namespace planlight
