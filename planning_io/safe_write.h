#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

namespace planlight {

/// Writes a file whole or not at all: temporary file beside it, sync, rename. Throws DiskError; the old file stays then.
void write_safely(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write);
void write_safely(const std::filesystem::path& file, const std::string& content);

/// The whole file. Throws InputError when it is missing, a folder or not readable.
std::string read_whole(const std::filesystem::path& file);

}  // namespace planlight
