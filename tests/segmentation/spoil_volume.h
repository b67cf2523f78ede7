#pragma once

#include "planning_io/types/volume.h"

namespace planlight::test {

/// The greys as a program for pictures writes them: 256 of them from `low` to the 99.8th percentile, what lies beyond
/// is cut. `low` as a share of that percentile; 0 cuts nothing off the dark end of an MR.
void window_to_8_bits(Volume& volume, double low);

/// The mean of the volume and of itself moved and turned about its middle, weighed by `share` (of the moved one): half
/// of the lines of k-space are those of a patient who lay elsewhere. Beyond the volume is 0.
void blend_with_moved(Volume& volume, const Eigen::Vector3d& by_mm, double degrees, double share = 0.5);

/// The ratio of two images of one head, from 0 to 1000, as MP2RAGE and quantitative maps show it: where there is no
/// signal, the ratio is noise as bright as tissue.
void divide_by_another(Volume& volume);

}  // namespace planlight::test
