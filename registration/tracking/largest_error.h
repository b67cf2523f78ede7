#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/pose_covariance.h"
#include "planning_io/types/rigid_transform.h"
#include "registration/tracking/pose_uncertainty.h"

namespace planlight {

/// About the markers' middle, mm: as far as the plan is taken to reach while nothing says where it lies.
constexpr double kPlanReach_mm = 100;

/// The error that the pose may have at a point in rig.
PredictedError predicted_error(const PoseUncertainty& uncertainty, const Eigen::Vector3d& p_in_rig);

/// The largest over `places_in_patient`. Without places: over the sphere of `kPlanReach_mm` about the middle, where the
/// mean square of the error is m + 2 b.r + r.A r with A >= 0: from the eigenvector of A's largest eigenvalue,
/// r <- |r| (A r + b) / |A r + b| climbs to its largest; the bound is the largest of those there and at the six ends of
/// the eigenvectors.
PredictedError largest_error(const PoseUncertainty& uncertainty, const RigidTransform& rig_from_patient,
                             const std::vector<Eigen::Vector3d>& places_in_patient);

/// How far apart two poses put what `largest_error` looks at; without places at most so far, mm.
double largest_distance(const RigidTransform& a, const RigidTransform& b, const Eigen::Vector3d& middle_in_patient,
                        const std::vector<Eigen::Vector3d>& places_in_patient);

/// Of many places those that lie outermost in one of 200 directions: the mean square of a pose's error is convex over
/// the body, so that it is largest at such a place (to 1 % for a plan as wide as a head). Few places are left as they
/// are.
std::vector<Eigen::Vector3d> outermost(const std::vector<Eigen::Vector3d>& places);

}  // namespace planlight
