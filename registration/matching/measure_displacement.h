#pragma once

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_displacement.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// How the skin's displacement is read from the residuals.
struct DisplacementSettings {
    double apart_mm = 4;           ///< the scan is gathered into places of this size,
    double most_apart_mm = 14;     ///< or of up to this one where its points are too few for them
    double alike_over_mm = 25;     ///< beyond the scan's rim the displacement goes back to the offset over this length
    double most_mm = 5;            ///< scan points farther from the CT's skin than this are not skin
    double facing_cosine = 0.5;    ///< nor are those that face another way than the skin by more (60 degrees)
    int min_points = 5;            ///< of a place
    int min_places = 40;           ///< fewer tell nothing
    double least_sigma_mm = 0.02;  ///< of a place: what all its points share
};

/// How far off the CT's skin the scan found the skin, place by place, at this pose: the medians of the signed
/// distances. Empty (`known()` false) when there are too few places. The pose is taken as it is: what it got wrong
/// along the normals is in the displacement, so that the skin drawn on is the skin that was scanned.
SkinDisplacement measure_displacement(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                                      const DisplacementSettings& settings = {});

}  // namespace planlight
