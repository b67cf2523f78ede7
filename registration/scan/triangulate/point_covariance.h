#pragma once

#include <Eigen/Core>

#include "planning_io/types/rig_calibration.h"
#include "registration/scan/triangulate/triangulate.h"

namespace planlight {

/// The covariance of a point that `seen` see together, mm^2, in rig, from what the calibration leaves alone (sigmas of
/// the settings; no noise). Devices that the rig does not have take no part. Zero where the rays say nothing about the
/// depth.
Eigen::Matrix3d expected_covariance(const Eigen::Vector3d& p_in_rig, const RigCalibration& rig,
                                    Triangulation::Seen seen = Triangulation::Seen::both,
                                    const TriangulationSettings& settings = {});

/// The covariance of a scanned point, mm^2, in rig.
///
/// A cloud keeps one number a point: `worst_sigma_mm`, one standard deviation along the worst direction. The shape
/// round it is that of `expected_covariance`.
Eigen::Matrix3d point_covariance(const Eigen::Vector3d& p_in_rig, const RigCalibration& rig, double worst_sigma_mm,
                                 Triangulation::Seen seen = Triangulation::Seen::both,
                                 const TriangulationSettings& settings = {});

}  // namespace planlight
