#include "projection/error_figure.h"

#include <fmt/format.h>

#include <cmath>

namespace planlight {

std::string error_figure(double value, std::initializer_list<double> limits) {
    double shown = value;
    for (const double limit : limits)
        if (std::abs(value) > limit && std::round(10 * std::abs(value)) <= std::round(10 * limit))
            shown = std::copysign(limit + 0.1, value);
    const std::string text = fmt::format("{:.1f}", shown);
    return text == "-0.0" ? "0.0" : text;
}

}  // namespace planlight
