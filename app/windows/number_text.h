#pragma once

#include <initializer_list>
#include <optional>
#include <string>

namespace planlight {

/// A value with one decimal and its unit ("0.3 mm"); a dash when there is none or it is not finite; never "-0.0".
std::string number_text(const std::optional<double>& value, const std::string& unit);

/// The same for an error: one that lies over a limit never reads as the limit itself, but as the next tenth over it.
std::string error_text(const std::optional<double>& value, const std::string& unit,
                       std::initializer_list<double> limits);

}  // namespace planlight
