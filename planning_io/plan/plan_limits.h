#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "planning_io/types/plan.h"

namespace planlight {

/// What a person can still read, as light on a head and in a table. A plan that holds more is refused, not drawn badly.
struct PlanLimits {
    std::size_t items = 300;
    std::size_t points = 50000;         ///< of all lines together
    std::size_t name_characters = 120;  ///< of an item's name, which is what is written beside it on the skin
};

/// Throws InputError with the number, the limit and what to do.
void check_plan_limits(const Plan& plan, const std::filesystem::path& file, const PlanLimits& limits = {});

/// Characters (code points) of a UTF-8 text.
std::size_t characters_of(const std::string& utf8);

/// The first `most` characters, with "..." where more were left out: for sentences about long names.
std::string shortened(const std::string& utf8, std::size_t most);

}  // namespace planlight
