#pragma once

#include <string>
#include <vector>

namespace planlight {

/// A short code for each item of a plan, "#3" or "#C", for where its name cannot be lit; all of one kind, all
/// different, and none that the name of another item (or what is lit of it, `lit`) could be taken for.
///
/// "#1", "#2" by the place in the plan, unless another item's name holds that number (a run of digits, leading zeros do
/// not count) or a numeral that is no digit 0 to 9. Then letters that look like no digit, of which no name has one
/// standing alone: "#A", "#C", then "#AA". Empty strings where even that is not enough. Both lists in the order of
/// `PlanDrawing::items`.
std::vector<std::string> codes_of(const std::vector<std::string>& names, const std::vector<std::string>& lit);

}  // namespace planlight
