#include "app/windows/number_text.h"

#include <fmt/format.h>

#include <cmath>

namespace planlight {

std::string number_text(const std::optional<double>& value, const std::string& unit) {
    if (!value || !std::isfinite(*value)) return "–";
    std::string text = fmt::format("{:.1f}", *value);
    if (text == "-0.0") text = "0.0";
    if (unit.empty()) return text;
    return text + (unit == "°" ? "" : " ") + unit;
}

}  // namespace planlight
