#include "app/windows/distance_colours.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace planlight {

Rgb distance_colour(double distance_mm, double largest_mm) {
    constexpr std::array<Rgb, 5> kStops{{{32, 178, 170}, {60, 220, 60}, {250, 225, 60}, {250, 140, 40}, {255, 50, 50}}};
    if (!std::isfinite(distance_mm)) return {150, 150, 150};
    const double place = std::clamp(std::abs(distance_mm) / largest_mm, 0.0, 1.0) * (kStops.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
    const double part = place - static_cast<double>(below);
    Rgb colour{};
    for (std::size_t c = 0; c < 3; ++c)
        colour[c] = static_cast<std::uint8_t>(std::lround((1 - part) * kStops[below][c] + part * kStops[below + 1][c]));
    return colour;
}

Rgb error_colour(double error_mm, double warn_mm, double stop_mm) {
    if (!std::isfinite(error_mm)) return {150, 150, 150};
    return error_mm <= warn_mm ? Rgb{56, 190, 122} : error_mm <= stop_mm ? Rgb{250, 194, 60} : Rgb{235, 70, 70};
}

Rgb risk_colour(std::size_t n) {
    constexpr std::array<Rgb, 6> kColours{
        {{70, 90, 255}, {175, 60, 235}, {150, 85, 30}, {110, 125, 145}, {0, 95, 130}, {205, 30, 130}}};
    return kColours[n % kColours.size()];
}

}  // namespace planlight
