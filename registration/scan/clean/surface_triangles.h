#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "planning_io/types/point_cloud.h"

namespace planlight {

/// From when on a side of a triangle bridges a gap.
struct SurfaceSettings {
    double max_edge_medians =
        4;                    ///< a triangle with a side longer than so many median sides is left out: there is a gap
    double max_edge_mm = 15;  ///< or longer than this
};

/// The scan as a surface: triangles over the points of the cloud (indices), counter-clockwise seen from the side that
/// the normals look to; some order of their own where there are none.
///
/// The points are joined by the Delaunay triangulation (CGAL) of the projector pixels that lit them, where they are
/// neighbours on the skin; of their places across the mean normal where the pixels are not known (a cloud of another
/// scanner, which must then be seen from one side). Sides that bridge a step or a shadow are longer than the rest and
/// left out. Empty for less than three finite points, or neither pixels nor normals.
std::vector<std::array<std::int32_t, 3>> surface_triangles(const PointCloud& cloud,
                                                           const SurfaceSettings& settings = {});

}  // namespace planlight
