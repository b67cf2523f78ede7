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

std::string error_text(const std::optional<double>& value, const std::string& unit,
                       std::initializer_list<double> limits) {
    std::optional<double> shown = value;
    for (const double limit : limits)
        if (value && std::abs(*value) > limit && std::round(10 * std::abs(*value)) <= std::round(10 * limit))
            shown = std::copysign(limit + 0.1, *value);
    return number_text(shown, unit);
}

}  // namespace planlight
