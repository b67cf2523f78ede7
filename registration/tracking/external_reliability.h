#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "planning_io/types/rigid_transform.h"

namespace planlight {

struct PatientMarker;
struct Sighting;

/// How far, in mm, one marker that slips by up to `slip_mm` in any direction may move the pose at the places that count
/// (`largest_error`) without the sightings disagreeing by more than `noticed_chi_square`: the external reliability of
/// the fit (Baarda 1968). To first order; at most sqrt(2) too large, as the slip is sought in an ellipsoid round both
/// limits. Infinite when the sightings do not determine a pose.
double external_reliability_mm(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                               const std::vector<Sighting>& sightings, const RigidTransform& rig_from_patient,
                               const std::vector<Eigen::Vector3d>& places_in_patient, double slip_mm,
                               double noticed_chi_square);

}  // namespace planlight
