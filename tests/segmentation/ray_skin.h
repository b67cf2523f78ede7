#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/volume.h"

namespace planlight::test {

/// Points of the outer skin in ct, found without any threshold for the whole, mask, flood or mesh: along parallel rays
/// from nine sides inwards to where the values leave the air that the ray itself has seen (by eight of its deviations,
/// for 3 mm); then along the normal that the neighbouring rays show, the first place that is half as far above that air
/// as what lies 2 mm deeper. Left out: rays whose neighbours end elsewhere (noise, rods, hair), those within 20 mm of
/// one that begins within the head (a cut side), and in HU those behind whose skin air follows within 12 mm (a couch,
/// a mask, the rim of an ear). ray_skin_test.cpp sets it against skins that are known.
std::vector<Eigen::Vector3d> ray_skin(const Volume& volume);

}  // namespace planlight::test
