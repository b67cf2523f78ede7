#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace planlight {

/// Of each sign of a line: even is read from the left, odd from the right (Unicode annex 9). All lines here run from
/// the left, for their sentences do, and a name of a plan must look the same in the light, the window and on paper;
/// what is from the right within them runs from the right, and figures keep their place and unit (`mark_figures`). The
/// text has no signs that order a direction (`orders_direction`).
std::vector<std::int8_t> reading_levels(const std::u32string& text);

/// A line of UTF-8 as a window draws it, sign by sign from the left: Arabic letters have their joined forms, signs
/// without ink (joiners, orders of a direction) are left out.
std::string visual_order(const std::string& line);

}  // namespace planlight
