#pragma once

#include <filesystem>

namespace planlight {

/// Keeps a folder and all that lies in it to its owner (folders 0700, files 0600), whatever the umask made of them. To
/// be asked before anything of a patient is written into it, so that nobody else ever comes in, and once more when it
/// is filled: its files may be taken out of it. Throws DiskError where its disk knows no permissions.
void keep_to_owner(const std::filesystem::path& folder);

}  // namespace planlight
