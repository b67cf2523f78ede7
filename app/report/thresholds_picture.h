#pragma once

#include "planning_io/types/image.h"
#include "planning_io/types/volume.h"
#include "segmentation/segment_skin.h"

namespace planlight {

/// The thresholds that are shown beside the one that was found, as shares of it: those between which `judge_skin` asks
/// how far the outline moves.
constexpr double kLowerThreshold = 0.7, kHigherThreshold = 1.5;

/// For who must choose: the skin's line on a sagittal, a coronal and an axial slice (rows) at three thresholds
/// (columns: lower, the one given, higher), each column with its threshold written over it. All slices go through the
/// middle of the volume. Where a threshold gives no skin there is no line.
RgbImage thresholds_picture(const Volume& volume, const SkinSettings& settings, double threshold);

}  // namespace planlight
