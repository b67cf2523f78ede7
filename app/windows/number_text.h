#pragma once

#include <optional>
#include <string>

namespace planlight {

/// A value with one decimal and its unit ("0.3 mm"); a dash when there is none or it is not finite; never "-0.0".
std::string number_text(const std::optional<double>& value, const std::string& unit);

}  // namespace planlight
