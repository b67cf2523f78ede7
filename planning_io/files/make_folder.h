#pragma once

#include <filesystem>

namespace planlight {

/// Makes the folder and those that it lies in, where they are not there yet. Throws DiskRefusal.
void make_folder(const std::filesystem::path& folder);

/// Makes it in a folder that is there. False when it is there already. Throws DiskRefusal.
bool make_new_folder(const std::filesystem::path& folder);

}  // namespace planlight
