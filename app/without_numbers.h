#pragma once

#include <string>

namespace planlight {

/// Numbers as "…": "the last pose is 83 ms old" and "... 91.5 ms old" are one reason.
std::string without_numbers(const std::string& text);

}  // namespace planlight
