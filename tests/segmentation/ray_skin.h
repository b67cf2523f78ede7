#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/volume.h"

namespace planlight::test {

/// Points of the outer skin in ct, found without any threshold for the whole, mask, flood or mesh: along parallel rays
/// from fourteen sides inwards, where the values leave the air that the ray itself has seen (by eight of its
/// deviations, for 3 mm), the half of the first crest behind. A ray whose neighbours end elsewhere (noise, rods, hair)
/// is left out.
std::vector<Eigen::Vector3d> ray_skin(const Volume& volume);

}  // namespace planlight::test
