#pragma once

#include <optional>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// What of a scan is skin where cloth may lie close on it, from a pose that is right to a millimetre or two.
///
/// Cloth lies outside of the skin only. The scan is gathered into places 5 mm wide; a small movement of the head and an
/// offset of its skin are fitted so that a fifth of the places lie below (quantile regression), which a second layer
/// over two thirds of them does not lift. Of what is left, the lowest dense value is the skin, and places stay that lie
/// no farther above it than three times the spread of those below. All points of a place stay or go together; what is
/// near no skin goes. Empty where nothing is to be left out: all places stay, less than a quarter would, or there are
/// few.
std::optional<PointCloud> innermost_layer(const PointCloud& cloud, const SkinLut& lut,
                                          const RigidTransform& ct_from_rig);

}  // namespace planlight
