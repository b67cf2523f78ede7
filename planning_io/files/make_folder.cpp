#include "planning_io/files/make_folder.h"

#include "planning_io/files/disk_refusal.h"

namespace planlight {

void make_folder(const std::filesystem::path& folder) {
    std::error_code fault;
    std::filesystem::create_directories(folder, fault);
    if (fault)
        throw DiskRefusal(folder, "cannot be made: " + fault.message(),
                          "Check the free space of its disk and the permissions of the folder that it lies in.", fault);
}

}  // namespace planlight
