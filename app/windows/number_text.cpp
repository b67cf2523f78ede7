#include "app/windows/number_text.h"

#include <cmath>

#include "projection/error_figure.h"

namespace planlight {
namespace {

std::string with_unit(const std::string& figure, const std::string& unit) {
    if (unit.empty()) return figure;
    return figure + (unit == "°" ? "" : " ") + unit;
}

}  // namespace

std::string number_text(const std::optional<double>& value, const std::string& unit) {
    return error_text(value, unit, {});
}

std::string error_text(const std::optional<double>& value, const std::string& unit,
                       std::initializer_list<double> limits) {
    if (!value || !std::isfinite(*value)) return "–";
    return with_unit(error_figure(*value, limits), unit);
}

}  // namespace planlight
