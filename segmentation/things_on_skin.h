#pragma once

#include <cmath>

#include "segmentation/middle_plane.h"
#include "segmentation/segment_skin.h"
#include "segmentation/skin_shape.h"

namespace planlight {

/// What lies on a head so that its surface is not the skin, as far as the surface's own shape betrays it. A figure that
/// could not be taken is not a number.
struct ThingsOnSkin {
    /// Of the head down to the chin: what stands out by over 10 mm before its mirror image in the head's middle plane
    /// (which is sought first). 0 to 2 on heads, 100 with a cushion at one cheek.
    double one_sided_cm2 = NAN;
    /// Of the upper head: what a ball of 12 mm that rolls within the surface leaves out by over 3 mm. Up to 6 on heads,
    /// 50 with sixty electrodes.
    double bumps_cm2 = NAN;
    /// Half the width at ears and jaw over the radius of the skull's ball; 0.9 to 1.2 on heads, 1.5 with head phones.
    double width = NAN;
    /// Behind and below the skull's middle, down to where shoulders begin: what looks up. A head recedes there towards
    /// the neck: 0 to 8 on heads, 30 and more with a cushion behind the neck.
    double shelf_cm2 = NAN;
    MiddlePlane plane;  ///< that was sought for the first
};

ThingsOnSkin things_on_skin(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin, const HeadBall& ball);

}  // namespace planlight
