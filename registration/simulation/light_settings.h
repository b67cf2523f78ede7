#pragma once

#include <array>
#include <cstdint>

#include "planning_io/types/time.h"

namespace planlight::simulation {

/// What a projector makes of a picture's numbers.
struct PanelSettings {
    double gamma = 2.2;
    double black = 1.0 / 700;             ///< light of a black pixel, share of white
    double dark_end = 0, bright_end = 1;  ///< shares of the scale: what lies beyond them looks the same (crushed)
    std::array<double, 3> colours{0.3, 0.5,
                                  0.2};  ///< of red, green and blue in white, as a monochrome sensor sees them
};

/// How light behaves in time. The defaults are a plain projector under steady lamps, seen in the middle of an exposure.
struct LightSettings {
    PanelSettings panel;
    double wheel_hz = 0;          ///< turns of a colour wheel of three equal segments a second; 0 = all colours at once
    double mains_hz = 0;          ///< of the room's lamps' flicker (twice the mains'); 0 = steady
    double mains_depth = 0;       ///< of that flicker, share of the lamps' light (amplitude)
    Instant untold_delay{};       ///< from order to light, beyond what the projector promises
    Instant jitter{};             ///< an order waits up to so much longer, evenly distributed
    double refresh_hz = 0;        ///< a picture becomes light at a refresh only; 0 = at once
    double skipped_orders = 0;    ///< share of the orders that never become light
    double lost_frames = 0;       ///< share of the cameras' frames that never arrive
    bool whole_exposure = false;  ///< a frame gets the light of all of its exposure; else of its middle

    bool over_exposure() const { return whole_exposure || wheel_hz > 0 || mains_hz > 0; }
};

/// Light of the room's lamps over an exposure, 1 = their mean.
double lamps_during(const LightSettings& settings, Instant opened, Instant closed);

/// The share of a turn's light of each colour that falls into an exposure, as a multiple of its even share (1 without a
/// wheel). Segments follow each other in the order red, green, blue.
std::array<double, 3> wheel_during(const LightSettings& settings, Instant opened, Instant closed);

/// True when this frame never arrives.
bool frame_is_lost(const LightSettings& settings, unsigned seed, std::int64_t number);

}  // namespace planlight::simulation
