#pragma once

#include <cstdint>
#include <vector>

#include "planning_io/types/volume.h"

namespace planlight::simulation {

/// Which voxels are the head (1) among those above the threshold: the largest body that is left when everything thinner
/// than about 4 mm is worn away, grown back within what is above the threshold. Head holder, table, cables and cushions
/// stay out. Empty when nothing of a head's size is above the threshold.
std::vector<std::uint8_t> head_voxels(const Volume& volume, double threshold);

/// Voxels at most `reach` voxels (a cube) from one that is set.
std::vector<std::uint8_t> grown(const std::vector<std::uint8_t>& mask, const std::array<int, 3>& size,
                                const std::array<int, 3>& reach);

}  // namespace planlight::simulation
