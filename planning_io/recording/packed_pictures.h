#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "planning_io/types/stereo_frame.h"

namespace planlight {

/// Both pictures of a frame with its times and its number, without loss (FORMATS.md).
std::string pack_frame(const StereoFrame& frame);

/// Throws DamagedFileError (`file`: for its words) where the bytes are no frame.
StereoFrame unpack_frame(std::string_view bytes, const std::filesystem::path& file);

/// A colour picture, without loss.
std::string pack_picture(const RgbImage& picture);
RgbImage unpack_picture(std::string_view bytes, const std::filesystem::path& file);

/// What tells pictures apart: XXH3-128 over sizes and pixels, hex.
std::string hash_of(const StereoFrame& frame);
std::string hash_of(const RgbImage& picture);

}  // namespace planlight
