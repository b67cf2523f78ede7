#pragma once

#include "app/igtl/igtl_messages.h"
#include "planning_io/types/plan.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// The skin as triangles.
LinkedShapes shapes_of(const TriangleMesh& skin);

/// The plan without its names: osteotomy lines, trajectories from entry to target, boreholes as a dot and, where axis
/// and depth are given, a line, and the borders of cut planes. Each cell's number is that of its item, from 0, in the
/// order of the plan: lines, trajectories, boreholes, planes.
LinkedShapes shapes_of(const Plan& plan);

}  // namespace planlight
