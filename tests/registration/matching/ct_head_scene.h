#pragma once

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/skin_lut.h"
#include "planning_io/types/volume.h"

namespace planlight::test {

/// The example patient's CT and the table made from it by segmentation, made once. Null when it is not installed.
struct CtHead {
    Volume volume;
    SkinLut lut;
};
const CtHead* ct_head();

/// What a camera at `eye_in_ct` would see of the CT: rays marched through the trilinear field to -300 HU, with the
/// field's gradient as normal; in ct. Independent of mesh and table. No hits within 3 mm of the first and last slice
/// (air above the end of a volume is not skin), none steeper than 75 degrees. Rays spread over `width_mm` at the
/// volume's middle.
PointCloud scan_of_ct(const Volume& volume, const Eigen::Vector3d& eye_in_ct, double width_mm, int points,
                      unsigned seed);

}  // namespace planlight::test
