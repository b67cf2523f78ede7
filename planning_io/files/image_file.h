#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/files/safe_write.h"
#include "planning_io/types/image.h"

namespace planlight {

/// PNG, written whole or not at all.
void write_png(const GrayImage& picture, const std::filesystem::path& file);
void write_png(const RgbImage& picture, const std::filesystem::path& file, ReadableBy readable_by = ReadableBy::umask);

/// The bytes of the same PNG.
std::string png_bytes(const RgbImage& picture);

/// PNG or TIFF, 8 or 16 bit (of which the upper 8 are kept), grey or colour (converted to grey by luma). Throws
/// DamagedFileError.
GrayImage read_gray(const std::filesystem::path& file);

/// Grey pictures become three equal channels. Throws InputError or DamagedFileError.
RgbImage read_rgb(const std::filesystem::path& file);

/// Brighter somewhere than a picture can be whose 12 bits stand at the lower end of 16.
bool brighter_than_low_bits(const GrayImage& picture);

/// A camera of 10 or 12 bits whose program stored them at the lower end of 16 leaves pictures that read as nearly
/// black. Throws InputError when `file`, one of a camera's pictures, has 16 bits and none of them all reaches 4096 of
/// 65535.
void check_depth(const std::vector<GrayImage>& pictures, const std::filesystem::path& file);

/// All pictures of a camera have one size: throws InputError when this one is not as large as the first.
void check_same_size(const GrayImage& picture, const GrayImage& first, const std::filesystem::path& file);

}  // namespace planlight
