#pragma once

#include <string>
#include <string_view>

namespace planlight {

/// A name from outside, of a plan's item or a file, as it may stand in a row, in light and on a terminal: line breaks
/// and control characters become one space; orders to turn the direction of what follows are left out, for they would
/// turn more than the name. UTF-8; bytes that are none stay, unless a terminal could take them for an order.
std::string on_one_line(std::string_view name);

}  // namespace planlight
