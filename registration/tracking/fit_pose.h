#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "registration/tracking/pose_uncertainty.h"
#include "registration/tracking/track_patient.h"

namespace planlight {

/// A known marker seen in one picture.
struct Sighting {
    int marker = -1;  ///< index into the reference markers
    bool left = true;
    MarkerObservation seen;
};

/// A pose and how well the sightings agree on it.
struct PoseFit {
    RigidTransform rig_from_patient = RigidTransform::Identity();
    double residual_px = 0;  ///< rms distance in the picture
    double chi_square = 0;   ///< by the sightings' sigmas
    /// Wider where the sightings agree less than their sigmas say. `fit_pose_checked` alone works it out, and the rest.
    PoseUncertainty uncertainty;
    /// One standard deviation in space, and the 95 % bound: the largest over the places that count (`largest_error`).
    double error_mm = 0, bound_95_mm = 0;
    double external_reliability_mm = 0;  ///< of a slip of 1 mm that the sightings do not show, there
};

/// How far a sighting's centre may be off, pixels: its own sigma and what calibration leaves.
double sighting_sigma_px(const MarkerObservation& seen);

/// The pose of least reprojection error in both pictures at once, from `start`: Levenberg-Marquardt on a twist about
/// the markers' centroid, Huber weights from 3 sigma. Empty when a marker falls behind a camera or the sightings leave
/// the pose undetermined.
std::optional<PoseFit> fit_pose(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                                const std::vector<Sighting>& sightings, const RigidTransform& start);

/// A pose after markers that do not agree were left out, or why there is none.
struct CheckedPose {
    std::optional<PoseFit> fit;  ///< empty when refused
    std::vector<Sighting> used;
    std::vector<MarkerDoubt> doubts;  ///< markers left out because they do not stand where they stood
    std::vector<int> in_place_again;  ///< of those set aside before: left out as well, but they stand where they stood
    std::string reason;               ///< why refused
};

/// `fit_pose`, then leave-one-out: while the markers do not agree within their noise, the one without which the others
/// agree is left out. Refused when too few remain, or so few that none can be left out to see which does not agree;
/// when two different markers explain the disagreement and the poses without them lie apart by more than 0.4 mm at the
/// places that count (closer, that distance is added to the bound); when the residual is too large; when the pose is
/// too uncertain at those places: the plan's (`PatientTracker::set_places`), or without any `kPlanReach_mm` all round;
/// and, where the plan is told, when a slip of one marker could move it far there without a sign
/// (`external_reliability_mm`). Markers of `set_aside` are not fitted, but looked at: they are doubted still, or in
/// their place again.
CheckedPose fit_pose_checked(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                             std::vector<Sighting> sightings, const RigidTransform& start,
                             const TrackingSettings& settings,
                             const std::vector<Eigen::Vector3d>& places_in_patient = {},
                             const std::vector<int>& set_aside = {});

/// How many different markers the sightings show.
int distinct_markers(const std::vector<Sighting>& sightings);

}  // namespace planlight
