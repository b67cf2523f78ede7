#pragma once

#include "app/session.h"

namespace planlight {

/// Compares a short scan (rig) with the CT's skin where `rig_from_ct` puts it, and with what `match` found: how far off
/// the plan's points are, or that the skin lies elsewhere (median more than `max_more_residual_mm` farther off it than
/// at the match), or that it is not known.
void compare_skin(const PointCloud& cloud, const Case& the_case, const RegistrationResult& match,
                  const RigidTransform& rig_from_ct, double max_more_residual_mm, SkinCheck& check);

}  // namespace planlight
