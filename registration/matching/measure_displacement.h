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
    double most_cover_mm = 20;     ///< a surface farther outside the skin does not lie on it
    double least_cover_mm = 1;     ///< outside the skin's offset, from where on it is none
    double most_slope = 0.45;      ///< of skin that swells, against the CT's
};

/// How far off the CT's skin the scan found the skin, place by place, at this pose: the medians of the signed
/// distances. Empty (`known()` false) when there are too few places. The pose is taken as it is: what it got wrong
/// along the normals is in the displacement, so that the skin drawn on is the skin that was scanned.
SkinDisplacement measure_displacement(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                                      const DisplacementSettings& settings = {});

/// Looks at all that the scan saw, taken for skin or not (`skin`: of what was): where nothing was found to be skin and
/// a surface lies outside of it, facing as it does, the CT's skin is covered (`SkinDisplacement::covered`), by a
/// swelling, a dressing, cloth, hair. A swelling rises from the skin on all sides without a step: it is skin, too, and
/// becomes places of it, so that light is drawn on it as it stands. Offset and spread stay those of the skin that was
/// matched.
void add_covered_skin(const PointCloud& all, const SkinLut& lut, const RigidTransform& ct_from_rig,
                      SkinDisplacement& skin, const DisplacementSettings& settings = {});

}  // namespace planlight
