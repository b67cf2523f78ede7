#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "registration/tracking/find_markers.h"

namespace planlight {

/// One disc of the left picture and one of the right that may be the same marker.
struct MarkerPair {
    int left = -1, right = -1;  ///< indices into the pictures' observations
    Eigen::Vector3d centre_in_rig;
    double sigma_mm = 0;  ///< rms per axis, one standard deviation, from the sigmas of the two centres
    double cost = 0;      ///< chi-square of the reprojection and of the disc's size
};

/// The point seen at both pixels: least squares on the reprojection. Empty when the rays are near parallel or meet
/// behind a camera. `sigma_mm` and `rms_px` tell its uncertainty and the remaining reprojection error (0 for both
/// perfect).
struct TriangulatedMarker {
    Eigen::Vector3d point_in_rig;
    double sigma_mm = 0;
    double largest_residual_px = 0;
};
std::optional<TriangulatedMarker> triangulate_marker(const RigCalibration& rig, const MarkerObservation& left,
                                                     const MarkerObservation& right);

/// Every pair that meets within `max_epipolar_px` in both pictures and whose disc would have about the true size.
std::vector<MarkerPair> possible_pairs(const RigCalibration& rig, const std::vector<MarkerObservation>& left,
                                       const std::vector<MarkerObservation>& right, const MarkerDesign& design,
                                       double max_epipolar_px);

/// Of all possible pairs a set in which each disc stands once, as many as possible and of the least total cost
/// (assignment problem, Kuhn 1955). Pairs that could be exchanged for a crossed couple of about the same cost are
/// ambiguous and left out.
std::vector<MarkerPair> consistent_pairs(const std::vector<MarkerPair>& possible, int left_count, int right_count);

}  // namespace planlight
