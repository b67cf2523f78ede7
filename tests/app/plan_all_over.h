#pragma once

#include <Eigen/Core>

#include "planning_io/types/plan.h"
#include "projection/skin_surface.h"

namespace planlight::test {

/// A plan over one side of the head, so that light from that side meets its items at all slants: on a grid about
/// `towards` (the way out of the head, ct) holes of 7 and 14 mm without and with a leaning axis and trajectories, lines
/// across between them, a cut plane through the middle. Only on real skin.
Plan plan_all_over(const SkinSurface& skin, const Eigen::Vector3d& towards);

}  // namespace planlight::test
