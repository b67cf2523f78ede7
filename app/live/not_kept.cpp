#include "app/live/not_kept.h"

#include <cerrno>

#include "planning_io/files/disk_refusal.h"

namespace planlight {

std::string short_words_of_not_kept(const std::exception& fault) {
    const auto* const disk = dynamic_cast<const DiskRefusal*>(&fault);
    switch (disk ? disk->why.value() : 0) {
        case ENOSPC:
        case EDQUOT:
            return "This match could not be kept: the disk is full.";
        case EACCES:
        case EPERM:
            return "This match could not be kept: its folder may not be written to.";
        case EROFS:
            return "This match could not be kept: the disk can only be read.";
        default:
            return "This match could not be kept: its folder cannot be written to.";
    }
}

}  // namespace planlight
