#pragma once

#include <string>
#include <vector>

#include "app/session.h"
#include "app/windows/operator_model.h"

namespace planlight {

/// What the operator window shows of a case before anything is scanned: title, skin, plan, table of its items.
OperatorModel model_of_case(const Case& the_case, const CaseDrawing& drawing);

/// What a registration was judged by, in words, one line each.
std::vector<std::string> evidence_of(const RegistrationResult& result);

}  // namespace planlight
