#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

namespace planlight {

/// Who may read a new file: whoever the user's umask lets, or nobody but its owner (0600, from its first byte on).
enum class ReadableBy { umask, owner };

/// Writes a file whole or not at all: temporary file beside it, sync, rename. Throws DiskError, also where the disk
/// cannot keep it to its owner; the old file stays then.
void write_safely(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write,
                  ReadableBy readable_by = ReadableBy::umask);
void write_safely(const std::filesystem::path& file, const std::string& content,
                  ReadableBy readable_by = ReadableBy::umask);

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
