#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// A place on a surface with a normal smoothed over about 15 mm, the same way on the scan and on the skin.
struct SurfaceSite {
    Eigen::Vector3f position, normal;
    bool contact = true;  ///< the normal is well enough defined for a contact point
};

/// The scan thinned to one site per 5 mm cell. Points that are not finite, and cells that lie apart from the surface
/// (few neighbours: stray points), are left out. Normals come from the cloud's.
std::vector<SurfaceSite> sites_of_cloud(const PointCloud& cloud);

/// Skin samples at least `spacing_mm` apart and covering the skin (Poisson disk); no seals, no cut planes, and only
/// where the normal is defined. The order is random, fixed by the seed.
std::vector<SurfaceSite> sites_of_skin(const SkinLut& lut, double spacing_mm, unsigned seed);

}  // namespace planlight
