#pragma once

#include <string>

namespace planlight {

/// A line of UTF-8 as a window draws it, sign by sign from the left: what is read from right to left stands in that
/// order (Unicode annex 9), and Arabic letters have their joined forms. Any other line as it is.
std::string visual_order(const std::string& line);

}  // namespace planlight
