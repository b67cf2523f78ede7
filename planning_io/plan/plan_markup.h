#pragma once

#include "planning_io/files/json_value.h"
#include "planning_io/types/plan.h"

namespace planlight {

/// One markup of a 3D Slicer markups file, into the plan, named `otherwise` where it has no name. Refused by name and
/// reason where it is not a plan item.
void append_markup(Plan& plan, const JsonValue& markup, bool units_required, const std::string& otherwise);

Json markup_of(const Trajectory& trajectory);
Json markup_of(const Borehole& borehole);
Json markup_of(const OsteotomyLine& line);
Json markup_of(const CutPlane& plane);

}  // namespace planlight
