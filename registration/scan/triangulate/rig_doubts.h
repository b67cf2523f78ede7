#pragma once

#include <vector>

#include "registration/scan/triangulate/rig_explanations.h"

// What the scan leaves open of a rig, and what that does to the light. Private to registration/scan/triangulate.
namespace planlight {

/// The change from `used` to `other`, moved so that the places of both lie on each other as well as they can.
RigDoubt doubt_between(const RigCalibration& used, const RigCalibration& other, const std::vector<SeenPlace>& places);

/// The few directions in which an explanation's own uncertainty bends the cloud most.
std::vector<RigDoubt> own_doubts(const Explanation& explanation, const RigCalibration& used,
                                 const std::vector<SeenPlace>& places);

/// `hidden_light_mm` that 95 % of the places stay within.
double hidden_over(const RigState& state, const std::vector<SeenPlace>& places);

}  // namespace planlight
