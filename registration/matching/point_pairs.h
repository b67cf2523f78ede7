#pragma once

#include <vector>

#include "planning_io/types/point_pair.h"
#include "planning_io/types/registration_result.h"

namespace planlight {

/// How landmarks may disagree.
struct PointPairSettings {
    double max_residual_mm = 5;   ///< rms of the landmarks after the fit; above: no
    double least_error_mm = 1.5;  ///< with which a landmark on skin is found and touched, at least, rms
    double min_spread_mm = 15;    ///< of the landmarks across their longest line, rms; below: no
    double max_check_mm = 4;      ///< of a landmark under a pose found otherwise; above: ask; twice as much: no
};

/// The fallback when a scan is not enough: the rigid pose that fits the landmarks best (Horn 1987). The verdict is at
/// best `ask`, for a small residual is no proof of a small error (Fitzpatrick 2009); the covariance is that of
/// Fitzpatrick, West & Maurer (1998), from the residual, but not from less than `least_error_mm`. A landmark that alone
/// spoils the fit is named.
RegistrationResult register_point_pairs(const std::vector<PointPair>& pairs, const PointPairSettings& settings = {});

/// How far each landmark lies from where the pose puts it, mm.
std::vector<double> landmark_errors_mm(const std::vector<PointPair>& pairs, const RigidTransform& patient_from_ct);

/// Holds landmarks against a pose that was found without them: one that is off lowers the verdict, with its name.
void check_with_point_pairs(const std::vector<PointPair>& pairs, RegistrationResult& result,
                            const PointPairSettings& settings = {});

}  // namespace planlight
