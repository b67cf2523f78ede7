#include "planning_io/files/check_exists.h"

#include <system_error>

#include "planning_io/types/error.h"

namespace planlight {

namespace fs = std::filesystem;

namespace {

/// The first folder on the way that may not be entered.
fs::path closed_folder(const fs::path& path) {
    fs::path way;
    for (const fs::path& part : fs::absolute(path)) {
        std::error_code fault;
        static_cast<void>(fs::status(way / part, fault));
        if (fault == std::errc::permission_denied) break;
        way /= part;
    }
    return way;
}

}  // namespace

void check_exists(const fs::path& path, const std::string& remedy) {
    std::error_code fault;
    const fs::file_status there = fs::status(path, fault);
    if (fs::exists(there)) return;
    if (fault == std::errc::permission_denied)
        throw InputError(path, "cannot be reached: the folder " + closed_folder(path).string() + " may not be entered",
                         "Ask its owner for the permission, or copy the file to a folder of your own.");
    if (there.type() != fs::file_type::not_found)
        throw InputError(path, "cannot be reached: " + fault.message(), "Check the name and the disk it is on.");
    std::error_code ignored;
    if (fs::is_symlink(path, ignored))
        throw InputError(path, "is a link to " + fs::read_symlink(path, ignored).string() + ", which does not exist",
                         "Name the file itself.");
    throw InputError(path, "does not exist", remedy);
}

}  // namespace planlight
