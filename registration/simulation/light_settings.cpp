#include "registration/simulation/light_settings.h"

#include <algorithm>
#include <cmath>

#include "registration/simulation/hash.h"

namespace planlight::simulation {

double lamps_during(const LightSettings& settings, Instant opened, Instant closed) {
    if (settings.mains_hz <= 0 || closed <= opened) return 1;
    const double turn = 2 * M_PI * settings.mains_hz, from = turn * seconds(opened), to = turn * seconds(closed);
    return 1 + settings.mains_depth * (std::sin(to) - std::sin(from)) / (to - from);
}

std::array<double, 3> wheel_during(const LightSettings& settings, Instant opened, Instant closed) {
    if (settings.wheel_hz <= 0 || closed <= opened) return {1, 1, 1};
    const double from = seconds(opened) * settings.wheel_hz, to = seconds(closed) * settings.wheel_hz;
    std::array<double, 3> shares{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double begins = static_cast<double>(c) / 3, ends = static_cast<double>(c + 1) / 3;
        // Turns of this segment's light until t: whole turns, and the part of the one that is under way.
        const auto lit_until = [&](double t) {
            const double whole = std::floor(t);
            return whole * (ends - begins) + std::clamp(t - whole, begins, ends) - begins;
        };
        shares[c] = 3 * (lit_until(to) - lit_until(from)) / (to - from);
    }
    return shares;
}

bool frame_is_lost(const LightSettings& settings, unsigned seed, std::int64_t number) {
    if (settings.lost_frames <= 0) return false;
    const std::uint64_t draw = mixed(mixed(seed + 7000ULL) ^ static_cast<std::uint64_t>(number));
    return static_cast<double>(draw >> 11U) * 0x1.0p-53 < settings.lost_frames;
}

}  // namespace planlight::simulation
