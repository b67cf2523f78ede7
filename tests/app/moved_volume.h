#pragma once

#include <Eigen/Core>
#include <string>

#include "planning_io/types/volume.h"

namespace planlight::test {

/// The volume of a patient whose skin moved since the CT: every point by a shift along the way out of the head's
/// middle. `how`: "still"; "waves" (two of 60 and 35 mm, `size_mm` high); "swelling" (a bump `size_mm` high and about
/// 60 mm across at `where_in_ct`); "thinner" (all over by `size_mm`). Throws std::invalid_argument for another word.
Volume with_moved_skin(const Volume& volume, const std::string& how, double size_mm, const Eigen::Vector3d& where_in_ct,
                       unsigned seed);

}  // namespace planlight::test
