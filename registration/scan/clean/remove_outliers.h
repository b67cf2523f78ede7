#pragma once

#include <cstddef>

#include "registration/scan/triangulate/triangulate.h"

namespace planlight {

/// From when on a point is not of the surface.
struct OutlierSettings {
    double max_grid_jump_mm = 3;       ///< to neighbours in the projector's grid
    double max_grazing_angle = 1.31;   ///< radians (75 degrees) between the normal and the way to the projector
    int min_piece_points = 400;        ///< smaller connected pieces are dropped
    double min_piece_fraction = 0.01;  ///< of the largest piece
    int max_points = 40000;            ///< thinned evenly to at most this many; 0 keeps all
};

/// The clean cloud (Fig. 2, right), with normals, and what was removed, by reason.
struct OutlierReport {
    PointCloud kept;
    std::size_t jump = 0, grazing = 0, small_piece = 0, lonely = 0, thinned = 0;
};

/// By the rules in the README, in their order; normals look to the projector. A point is counted under the first that
/// drops it.
OutlierReport remove_outliers(const Triangulation& raw, const RigCalibration& rig,
                              const OutlierSettings& settings = {});

}  // namespace planlight
