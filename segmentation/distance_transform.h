#pragma once

#include <cstdint>
#include <vector>

#include "segmentation/voxel_morphology.h"

namespace planlight {

/// Distance of each voxel's centre from the nearest voxel where `mask` is `target`, mm; exact, at most `longest_mm`.
std::vector<float> distance_from(const Mask& mask, std::uint8_t target, const VoxelGrid& grid, double longest_mm);

}  // namespace planlight
