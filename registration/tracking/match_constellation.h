#pragma once

#include <optional>
#include <string>
#include <vector>

#include "registration/tracking/fit_pose.h"
#include "registration/tracking/pair_markers.h"

namespace planlight {

/// Which discs are which markers, and the pose that says so.
struct ConstellationMatch {
    std::optional<RigidTransform> rig_from_patient;
    std::vector<Sighting> sightings;
    int needed = 0;      ///< markers that must agree for the pose to be believed
    std::string reason;  ///< why there is no match
};

/// Which disc is which marker, from the distances between the triangulated discs: every three points that have the
/// distances of three markers propose a pose, and the pose that puts most markers on a disc wins. Two different poses
/// that explain as many are an ambiguity; it is settled by `guess` when one is much nearer to it, and refused
/// otherwise.
ConstellationMatch match_constellation(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                                       const std::vector<MarkerObservation>& left,
                                       const std::vector<MarkerObservation>& right,
                                       const std::optional<RigidTransform>& guess, const TrackingSettings& settings);

/// The discs within `max_px` of where `rig_from_patient` puts the markers; each disc and each marker at most once.
std::vector<Sighting> sightings_near(const RigCalibration& rig, const std::vector<PatientMarker>& markers,
                                     const RigidTransform& rig_from_patient, const std::vector<MarkerObservation>& left,
                                     const std::vector<MarkerObservation>& right, double max_px);

}  // namespace planlight
