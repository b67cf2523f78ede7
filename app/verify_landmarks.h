#pragma once

#include <string>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "projection/skin_surface.h"

namespace planlight {

/// Places of the skin at which a person can see by eye whether light lies right: where the skin bends most (the tip of
/// the nose, the rim of an eye socket, a chin), that the projector lights and both cameras see with the head at
/// `rig_from_ct`, at least `apart_mm` from each other. Two, or fewer where the skin has none; ct, mm.
std::vector<Eigen::Vector3d> landmarks_to_verify(const SkinSurface& skin, const RigCalibration& rig,
                                                 const RigidTransform& rig_from_ct, double apart_mm = 40);

/// Where on the head a place of the skin lies, for a person who looks for it: "front, right, low". Of these only what
/// is clearly so; the patient's own right and left. Empty in the middle of everything.
std::string words_of_place(const SkinSurface& skin, const Eigen::Vector3d& place_in_ct);

}  // namespace planlight
