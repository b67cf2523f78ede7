#pragma once

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_displacement.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

struct CoveredSkinSettings {
    double facing_cosine = 0.5;    ///< a surface that faces another way than the skin by more does not lie on it
    double most_mm = 20;           ///< nor does one farther outside of it
    double least_mm = 1;           ///< outside the skin's offset: less is skin
    double most_slope = 0.45;      ///< of skin that swells, against the CT's
    std::size_t min_points = 5;    ///< of a place
    double least_sigma_mm = 0.02;  ///< of a place: what all its points share
};

/// Looks at all that the scan saw, taken for skin or not (`skin`: of what was): where nothing was found to be skin and
/// a surface lies outside of it, facing as it does, the CT's skin is covered (`SkinDisplacement::covered`), by a
/// swelling, a dressing, cloth, hair. A swelling rises from the skin on all sides without a step: it is skin, too, and
/// becomes places of it, so that light is drawn on it as it stands. Offset and spread stay those of the skin that was
/// matched.
void add_covered_skin(const PointCloud& all, const SkinLut& lut, const RigidTransform& ct_from_rig,
                      SkinDisplacement& skin, const CoveredSkinSettings& settings = {});

}  // namespace planlight
