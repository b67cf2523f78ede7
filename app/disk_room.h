#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace planlight {

/// How much is free where a folder is, or will be.
struct DiskRoom {
    std::filesystem::path folder;
    double free_gb = 0;
};

/// Of the folder's disk; of that of the nearest folder above it where it is not there yet. Infinite where the disk does
/// not say.
DiskRoom disk_room_of(const std::filesystem::path& folder);

/// What must be known before a session begins, a sentence for each folder without room, with the option that names
/// another. `recordings`: nothing where nothing is recorded; matches are kept all the same.
std::vector<std::string> warnings_of_full_disks(const std::optional<DiskRoom>& recordings, const DiskRoom& matches);

}  // namespace planlight
