#include "app/disk_room.h"

#include <fmt/format.h>

#include <limits>
#include <system_error>

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr double kEnough_gb = 1;  // an hour's recording

}  // namespace

DiskRoom disk_room_of(const fs::path& folder) {
    std::error_code fault;
    fs::path there = fs::absolute(folder, fault);
    while (!fs::exists(there, fault) && there.has_parent_path() && there.parent_path() != there)
        there = there.parent_path();
    const fs::space_info space = fs::space(there, fault);
    return {folder, fault ? std::numeric_limits<double>::infinity() : static_cast<double>(space.available) / 1e9};
}

std::vector<std::string> warnings_of_full_disks(const std::optional<DiskRoom>& recordings, const DiskRoom& matches) {
    std::vector<std::string> warnings;
    const auto look = [&](const DiskRoom& room, const char* what_happens, const char* option) {
        if (room.free_gb >= kEnough_gb) return;
        warnings.push_back(fmt::format(
            "Only {:.0f} MB are free in {}: {}; the light goes on. Make room on the disk, or name another folder "
            "with {}.",
            1e3 * room.free_gb, room.folder.string(), what_happens, option));
    };
    if (recordings) look(*recordings, "the recording ends where the disk is full", "--recordings");
    look(matches, "a match and its scan may not be kept there", "--keep");
    return warnings;
}

}  // namespace planlight
