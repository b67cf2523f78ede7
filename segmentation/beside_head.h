#pragma once

#include "planning_io/types/volume.h"
#include "segmentation/segment_skin.h"

namespace planlight {

/// Radius of the largest ball within what shows outside the body as brightly as skin does, filled, mm; at most 60. A
/// table and its cushions hold one of 20, an arm of 40, another head of 45 (a newborn's) to 80.
double ball_beside_head_mm(const Volume& volume, const SkinMask& mask);

}  // namespace planlight
