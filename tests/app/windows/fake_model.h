#pragma once

#include "app/windows/operator_model.h"

namespace planlight::test {

/// An operator model on the analytic head, with a plan on its right forehead; figures are invented.
OperatorModel fake_model();

}  // namespace planlight::test
