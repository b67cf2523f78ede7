#pragma once

#include <cstdint>
#include <vector>

#include "planning_io/types/image.h"

namespace planlight::simulation {

/// Lens blur and sensor of one camera.
struct Sensor {
    int width = 0, height = 0;
    double blur_px = 0.6;        ///< sigma of the lens
    double corner_light = 0.85;  ///< of the middle's: vignetting
    bool noise = true;
    std::uint64_t seed = 0;  ///< another one for every camera
};

/// Light in full scales (1 = 255) becomes an 8-bit picture; `light` is worked on. Noise depends on `frame` and the
/// seed.
GrayImage sense(const Sensor& sensor, std::vector<float>& light, std::uint64_t frame);

}  // namespace planlight::simulation
