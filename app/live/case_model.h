#pragma once

#include <string>
#include <vector>

#include "app/session.h"
#include "app/windows/operator_model.h"

namespace planlight {

/// What the operator window shows of a case before anything is scanned: title, skin, plan, table of its items.
OperatorModel model_of_case(const Case& the_case, const CaseDrawing& drawing);

/// How far off each item of the plan may be by the registration, 95 %, mm: its worst point. In the order in which
/// `draw_plan` gives the items. Infinite where the scan held too little skin to tell.
std::vector<double> predicted_errors_mm(const Plan& plan, const RegistrationResult& found);

/// What a registration was judged by, in words, one line each.
std::vector<std::string> evidence_of(const RegistrationResult& result);

}  // namespace planlight
