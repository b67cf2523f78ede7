#pragma once

#include <string>
#include <vector>

#include "planning_io/types/plan.h"
#include "projection/lettering.h"

namespace planlight {

/// The name of one item as the light has it.
struct LitName {
    std::string name;     ///< whole, shortened in the middle, or "#3" for the third item of the plan
    std::string warning;  ///< why it is not the plan's, in words with what to do; empty where it is, or only shorter
};

/// "#3": an item by its place in `PlanDrawing::items`, where its name cannot be lit.
std::string number_of(int item);

/// The names of a plan's items as light: never a wrong one. A name of which no font has every sign is left out, and one
/// that shortening makes the same as another's: the item then has its number in the plan.
std::vector<LitName> lit_names(const std::vector<std::string>& names, double text_height_mm,
                               const Lettering& letters = lettering());

/// The names of all items in the order of `PlanDrawing::items`; a line or plane without one is called by its kind.
std::vector<std::string> names_of(const Plan& plan);

/// Warnings of the names of a plan that cannot be written in light, and where this computer has no font at all.
std::vector<std::string> check_names(const Plan& plan, double text_height_mm);

}  // namespace planlight
