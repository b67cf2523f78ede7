#pragma once

#include <random>
#include <vector>

#include "registration/simulation/head_pose.h"
#include "registration/simulation/optics.h"
#include "registration/simulation/skin_look.h"
#include "registration/simulation/true_surface.h"

namespace planlight::simulation {

/// Where a nurse would put the stickers: round the region, apart from one another, off the plan, on flat skin that
/// faces the light and both cameras (all devices given in ct). Fewer than `count` when there is no room for more.
std::vector<Sticker> place_stickers(const TrueSurface& skin, const WorkRegion& region,
                                    const std::vector<Eigen::Vector3d>& keep_clear_in_ct, const Optics& left,
                                    const Optics& right, const Optics& projector, int count, std::mt19937& random);

}  // namespace planlight::simulation
