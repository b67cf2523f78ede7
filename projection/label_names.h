#pragma once

#include <string>
#include <vector>

#include "planning_io/types/plan.h"
#include "projection/lettering.h"

namespace planlight {

/// The name of one item as the light has it.
struct LitName {
    std::string name;      ///< whole, shortened in the middle, or the code; empty: no label, or a hole without a name
    std::string warning;   ///< why it is not the plan's, in words with what to do; empty where it is, or only shorter
    std::string code;      ///< "#3" or "#C", where the name cannot be lit or has no room (`codes_of`); may be empty
    bool by_code = false;  ///< `name` is the code
    bool none = false;     ///< neither name nor code can be lit: the item has no label at all
};

/// The names of a plan's items as light: never a wrong one, and none twice. A name of which no font has every sign is
/// left out, and one that is, or is by shortening, the same as another's: the item then has its code, or no label where
/// no code is clear.
std::vector<LitName> lit_names(const std::vector<std::string>& names, double text_height_mm,
                               const Lettering& letters = lettering());

/// The names of a plan's risk structures as light: a name that no font has, or that shortened is another's, is
/// "structure 2" by its place in the plan, and warned of.
std::vector<LitName> lit_structures(const Plan& plan, double text_height_mm, const Lettering& letters = lettering());

/// The names of all items in the order of `PlanDrawing::items`; a line or plane without one is called by its kind.
std::vector<std::string> names_of(const Plan& plan);

/// Why `PLANLIGHT_FONT` is not what the light is written with, in words; empty where it is, or is not set.
std::string fault_of_own_font(const Lettering& letters = lettering());

/// Warnings of the names of a plan that cannot be written in light, and where this computer has no font at all or not
/// the one that was wanted.
std::vector<std::string> check_names(const Plan& plan, double text_height_mm);

}  // namespace planlight
