#pragma once

#include "app/windows/operator_model.h"

namespace planlight::test {

/// An operator model on the analytic head, with a plan on its right forehead; figures are invented.
OperatorModel fake_model();

/// The analytic head, so much smaller, about `middle_in_ct`.
RiskStructure risk_structure(const std::string& name, const Eigen::Vector3d& middle_in_ct, double size);

/// The same in another state, with buttons, steps and sentences that fit it.
OperatorModel fake_model_with(StatusKind kind);

}  // namespace planlight::test
