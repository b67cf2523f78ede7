#pragma once

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_displacement.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// What of a later scan, at a pose that is to be checked, lies over skin.
struct SkinAgain {
    PointCloud cloud;      ///< facing as the CT's skin and within 10 mm of it, in rig; with normals where the scan has
    double median_mm = 0;  ///< of these from the skin, absolute; 0 when there are none
    double near_share = 0, inside_share = 0;  ///< of these within 1 mm of the skin, and farther inside of it
};

/// Cloth beside the skin is left out: it says nothing of where the skin lies. `found` known: only in the
/// places where that match found skin among cloth; not known: wherever the CT shows skin. Distances are counted
/// from `skin_offset_mm` outside of the CT's skin.
SkinAgain skin_again(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                     const SkinDisplacement& found, double skin_offset_mm);

}  // namespace planlight
