#pragma once

#include "planning_io/types/plan.h"

namespace planlight {

/// The plan that comes with Planlight for the example patient (app/example/frontal_defect.mrk.json): a closed osteotomy
/// line round the right frontal defect, four boreholes at its corners, one trajectory 60 mm deep.
/// Read from the source tree or, installed, from the share folder beside the program. Throws InputError when neither is
/// there.
Plan example_plan();

}  // namespace planlight
