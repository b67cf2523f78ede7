#include "planning_io/files/keep_to_owner.h"

#include "planning_io/types/error.h"

namespace planlight {

namespace fs = std::filesystem;

namespace {

void keep_one(const fs::path& path, fs::perms wanted) {
    std::error_code fault;
    fs::permissions(path, wanted, fault);
    if (!fault && (fs::status(path, fault).permissions() & fs::perms::all) == wanted) return;
    throw DiskError(path, "cannot be kept from others: this disk gives it to everybody on the computer",
                    "Name a folder on a disk that knows permissions.");
}

}  // namespace

void keep_to_owner(const fs::path& folder) {
    keep_one(folder, fs::perms::owner_all);
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_symlink()) continue;  // what it leads to is somebody else's
        keep_one(entry.path(),
                 entry.is_directory() ? fs::perms::owner_all : fs::perms::owner_read | fs::perms::owner_write);
    }
}

}  // namespace planlight
