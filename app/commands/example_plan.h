#pragma once

#include "planning_io/types/plan.h"

namespace planlight {

/// The plan that comes with Planlight for the example patient (app/example/frontal_defect.mrk.json): a closed osteotomy
/// line round the right frontal defect, four boreholes at its corners, one trajectory 60 mm deep.
/// Read from share/planlight beside the program's folder, where the build and the installation put it. Throws
/// InputError when it is not there.
Plan example_plan();

}  // namespace planlight
