#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

namespace planlight {

/// Writes a file whole or not at all: temporary file beside it, sync, rename. Throws DiskError; the old file stays
/// then.
void write_safely(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write);
void write_safely(const std::filesystem::path& file, const std::string& content);

/// Throws what `write_safely` would where the file cannot be written there (no such folder, no permission, a folder of
/// that name): to be asked before long work.
void check_can_write(const std::filesystem::path& file);

/// The same for `write_folder_safely` into a folder that is new, empty or to be replaced.
void check_new_folder(const std::filesystem::path& folder);

/// Makes a folder whole or not at all: `fill` writes into a temporary folder beside it, which is then renamed. An
/// existing empty folder, or a link to one, is taken; another existing one is exchanged for the new one in one step if
/// `replace`, else InputError.
void write_folder_safely(const std::filesystem::path& folder, bool replace,
                         const std::function<void(const std::filesystem::path&)>& fill);

/// The whole file. Throws InputError when it is missing, a folder or not readable.
std::string read_whole(const std::filesystem::path& file);

}  // namespace planlight
