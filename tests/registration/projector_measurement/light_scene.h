#pragma once

#include <cstdint>
#include <functional>
#include <random>

#include "registration/projector_measurement/light_recording.h"

namespace planlight::test {

/// A recording by formula, without pictures: 24 tiles of each camera see the projector, each as bright as it likes;
/// every frame gets the mean of `light_at` over its exposure. No simulator and no product code is in it.
struct LightScene {
    Instant interval = std::chrono::milliseconds(20), exposure = std::chrono::milliseconds(5);
    Instant delay = std::chrono::milliseconds(40);                       ///< from order to light
    double noise_grey = 0.05;                                            ///< of a tile's mean
    double room_grey = 20, white_grey = 130;                             ///< of a tile in the middle of the range
    std::function<double(double)> room_at = [](double) { return 1.0; };  ///< of the room's light, by seconds
    std::function<double(double)> lamp_at = [](double) { return 1.0; };  ///< of the projector's light
    std::function<double(Rgb)> light_of = [](Rgb c) { return (0.3 * c[0] + 0.5 * c[1] + 0.2 * c[2]) / 255; };
    std::function<double(double)> camera = [](double grey) { return grey; };  ///< what a pixel makes of light, in grey
    double saturates_at = 1e9;                                                ///< of a tile's grey

    /// Frames one after the other from 0 to `until`, under these orders.
    LightRecording record(const std::vector<LightOrder>& orders, Instant until, unsigned seed = 1) const;
};

/// Steady colours one after the other, each for so many frames.
std::vector<LightOrder> steady_orders(const std::vector<Rgb>& colours, Instant each, Instant begins = {});

/// Black and white at rest, then the bits given, each `bit` long; ends dark.
std::vector<LightOrder> flashes(const std::vector<bool>& bits, Instant bit);

inline Rgb grey(int v) {
    const auto g = static_cast<std::uint8_t>(v);
    return {g, g, g};
}

}  // namespace planlight::test
