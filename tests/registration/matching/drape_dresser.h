#pragma once

#include "planning_io/types/triangle_mesh.h"
#include "tests/registration/matching/draped_scene.h"
#include "tests/registration/matching/head_heights.h"

namespace planlight::test {

/// The things of a draping (`settings.draping`) round the face, in the view's frame; drawn from the settings' seed.
/// Throws std::invalid_argument for a draping that is not of drapings().
TriangleMesh things_round(const HeadHeights& head, const DrapedSceneSettings& settings);

}  // namespace planlight::test
