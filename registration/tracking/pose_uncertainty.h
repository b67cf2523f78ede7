#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/rig_calibration.h"

namespace planlight {

struct PatientMarker;
struct Sighting;

/// How far from the truth a tracked pose may be: the covariance of a small turn (rotation vector, radians) about
/// `middle_in_rig` and of a shift of it (mm), both in rig.
struct PoseUncertainty {
    Eigen::Matrix<double, 6, 6> of_turn_and_shift = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Vector3d middle_in_rig = Eigen::Vector3d::Zero();  ///< of all reference markers
};

/// First-order propagation of three sources through the least-squares fit of `rig_from_patient` to the sightings:
/// - the noise of the discs' centres;
/// - the noise of the reference places, shared by both cameras;
/// - what the calibration leaves of each camera (pose, focal length, principal point, distortion, see the .cpp): the
///   reference places were measured through the same cameras, so that it cancels where both cameras look and the head
///   has not moved, and not where one camera is left, or far from the reference.
/// Infinite when the sightings do not determine a pose. What it means at a place: `predicted_error`, `largest_error`.
PoseUncertainty pose_uncertainty(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                                 const std::vector<Sighting>& sightings, const RigidTransform& rig_from_patient);

}  // namespace planlight
