#pragma once

#include <functional>

#include "segmentation/segment_skin.h"

namespace planlight {

/// The body of an MR: its outline is found on a survey (`outline_of`), then drawn with the volume's own voxels within a
/// band round it. What the outline encloses is body, however dark; what lies outside is away, however bright.
SkinMask segment_mr_skin(const Volume& volume, const SkinSettings& settings,
                         const std::function<void(double)>& progress);

}  // namespace planlight
