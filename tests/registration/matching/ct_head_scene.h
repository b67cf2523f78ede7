#pragma once

#include <vector>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
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

/// The same from the front, half left, half right, left (`i` in turn), 0.9 m from the CT's middle.
PointCloud ct_view(const CtHead& head, unsigned i, double width_mm, int points);

/// As by a patient who slowly turned while the table moved: every slice about the body's axis, the more the higher.
PointCloud twisted(PointCloud cloud, double rad_per_mm);

/// How far beside a place of the CT's skin light that is drawn by the pose falls from where that place is in rig, mm:
/// of each point of the scan `of_ct`, which lies at the same index of `in_rig`.
std::vector<double> light_off_mm(const RigidTransform& patient_from_ct, const PointCloud& of_ct,
                                 const PointCloud& in_rig);

}  // namespace planlight::test
