#pragma once

#include <Eigen/Core>
#include <vector>

#include "registration/tracking/fit_pose.h"

namespace planlight {

/// How far from its true place the markers' middle may lie that a pose gives.
struct PoseUncertainty {
    Eigen::Matrix3d covariance_mm2 = Eigen::Matrix3d::Zero();  ///< of the middle of all reference markers, rig
    double sigma_mm = 0;                                       ///< root of the trace: one standard deviation in space
    double bound_95_mm = 0;                                    ///< the error is smaller in 95 of 100 cases
};

/// First-order propagation of three sources through the least-squares fit of `rig_from_patient` to the sightings:
/// - the noise of the discs' centres;
/// - the noise of the reference places, shared by both cameras;
/// - what the calibration leaves of each camera (pose, focal length, principal point, distortion, see the .cpp): the
///   reference places were measured through the same cameras, so that it cancels where both cameras look and the head
///   has not moved, and not where one camera is left, or far from the reference.
/// Infinite when the sightings do not determine a pose.
PoseUncertainty pose_uncertainty(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                                 const std::vector<Sighting>& sightings, const RigidTransform& rig_from_patient);

}  // namespace planlight
