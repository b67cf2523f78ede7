#pragma once

#include <functional>
#include <random>

#include "registration/simulation/room_things.h"

namespace planlight::simulation {

/// How high something stands over a plane at (x, y), mm.
using Ground = std::function<double(double, double)>;

/// A sheet that was let fall onto the ground and rests there: knots of a net held by threads along it, across it and
/// over two (so that it bends stiffly), pulled down, pushed out of the ground; Verlet steps with the threads kept at
/// their lengths (Provot 1995; Jakobsen 2001).
struct SheetSettings {
    double width_mm = 460, knot_mm = 6;
    double hole_mm = 0;         ///< width of a hole in its middle; 0: none
    double thickness_mm = 0.8;  ///< over the ground
    double slack = 0.04;        ///< how much more cloth there is than ground under it: folds
    int steps = 220;
};
/// In the frame of the ground (z up).
ThingsMesh sheet_on(const Ground& ground, const SheetSettings& settings, std::mt19937& random);

}  // namespace planlight::simulation
