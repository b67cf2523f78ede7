#pragma once

#include <string>
#include <system_error>
#include <utility>

#include "planning_io/types/error.h"

namespace planlight {

/// A write that was refused, with what the system said: whoever has room for a few words only asks for that.
class DiskRefusal : public DiskError {
public:
    DiskRefusal(const std::filesystem::path& file, const std::string& problem, std::string what_to_do,
                std::error_code what_system_said)
        : DiskError(file, problem, std::move(what_to_do)), why(what_system_said) {}
    std::error_code why;
};

/// What a person can do about a file or folder that could not be written, by what the system said.
inline const char* remedy_of_unwritable(const std::error_code& why) {
    if (why == std::errc::filename_too_long) return "Choose a shorter name.";
    if (why == std::errc::read_only_file_system) return "This disk can only be read: name a folder on another one.";
    if (why == std::errc::permission_denied || why == std::errc::operation_not_permitted)
        return "Ask for the permission to write in that folder, or name one of your own.";
    return "Check the free space and the permissions of the folder, then write again.";
}

}  // namespace planlight
