#include "planning_io/files/make_folder.h"

#include "planning_io/files/disk_refusal.h"

namespace planlight {
namespace {

void check_made(const std::filesystem::path& folder, const std::error_code& fault) {
    if (fault) throw DiskRefusal(folder, "cannot be made: " + fault.message(), remedy_of_unwritable(fault), fault);
}

}  // namespace

void make_folder(const std::filesystem::path& folder) {
    std::error_code fault;
    std::filesystem::create_directories(folder, fault);
    check_made(folder, fault);
}

bool make_new_folder(const std::filesystem::path& folder) {
    std::error_code fault;
    const bool made = std::filesystem::create_directory(folder, fault);
    check_made(folder, fault);
    return made;
}

}  // namespace planlight
