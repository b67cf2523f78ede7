#pragma once

#include <string>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "projection/skin_surface.h"

namespace planlight {

inline constexpr double kLandmarkRing_mm = 10;  ///< of light round a landmark, across

/// Places of the skin at which a person can see by eye whether light lies right: where the skin bends most (the tip of
/// the nose, the rim of an eye socket, a chin), that the projector lights and both cameras see with the head at
/// `rig_from_ct`, at least `apart_mm` from each other. Where the skin has such places, at least 85 % of the ring round
/// each can be lit and seen by each camera at 60 degrees or less to the skin's normal: the cameras measure it there,
/// and an ear's rim, which bends most of all and with every pillow, is no such place. Else at up to 75 degrees, else as
/// much as can. Two, or fewer where the skin has none; ct, mm.
std::vector<Eigen::Vector3d> landmarks_to_verify(const SkinSurface& skin, const RigCalibration& rig,
                                                 const RigidTransform& rig_from_ct, double apart_mm = 40);

/// From where to look at a place of the skin and the ring round it so that nothing of the head is before it: the way
/// that is nearest to its normal (a rim of the ear may face the head behind it), of those near the horizontal of ct,
/// from which the head is seen upright. Unit, from the skin towards the eye, in ct; where none is free that from which
/// most of the ring is seen.
Eigen::Vector3d free_view_of(const SkinSurface& skin, const Eigen::Vector3d& place_in_ct);

/// Where on the head a place of the skin lies, for a person who looks for it: "front, right, low". Of these only what
/// is clearly so; the patient's own right and left. Empty in the middle of everything.
std::string words_of_place(const SkinSurface& skin, const Eigen::Vector3d& place_in_ct);

}  // namespace planlight
