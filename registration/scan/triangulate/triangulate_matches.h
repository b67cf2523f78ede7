#pragma once

#include <cstddef>

#include "registration/scan/triangulate/match_views.h"
#include "registration/scan/triangulate/triangulate.h"

namespace planlight {

/// The matches of two views at the stride of the settings. Throws std::invalid_argument as `triangulate`; both
/// directions must be coded.
ViewMatches match_views(const DecodedView& left, const DecodedView& right, const RigCalibration& rig,
                        const TriangulationSettings& settings);

/// The points of the matches: the part of `triangulate` that needs the rig, to be done again when the rig changes. Of
/// the matches only every `every`-th.
Triangulation triangulate_matches(const ViewMatches& matches, const RigCalibration& rig,
                                  const TriangulationSettings& settings, std::size_t every = 1);

}  // namespace planlight
