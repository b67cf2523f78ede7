#pragma once

#include "planning_io/types/volume.h"

namespace planlight::test {

struct SurfaceDistance {
    double median_mm = 0, p90_mm = 0;
    int points = 0;  ///< looked at: every few of the points of a's surface that lie inside of b's volume
};

/// From the iso-surface of `a` to that of `b` at one level, in ct, where both volumes exist (a voxel of margin).
SurfaceDistance surface_distance(const Volume& a, const Volume& b, double level);

}  // namespace planlight::test
