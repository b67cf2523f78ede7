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

}  // namespace planlight
