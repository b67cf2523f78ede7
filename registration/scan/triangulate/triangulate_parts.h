#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "registration/scan/triangulate/triangulate.h"

// What triangulation with rows and with columns only have in common. Private to registration/scan.
namespace planlight {

/// What became of one camera pixel.
struct PointOutcome {
    enum class Kind : unsigned char {
        nothing,
        point,
        no_partner,
        ragged,
        disagree,
        outside_volume
    } kind = Kind::nothing;
    Triangulation::Seen seen = Triangulation::Seen::both;
    Eigen::Vector3d p_in_rig = Eigen::Vector3d::Zero();
    Eigen::Vector2d pixel_in_projector = Eigen::Vector2d::Zero();
    double sigma_mm = 0;
    bool placed_by_cameras = false;                                 ///< then the next three are set
    Eigen::Vector3d p_by_cameras = Eigen::Vector3d::Zero();         ///< without the projector
    Eigen::Vector2d projector_offset_px = Eigen::Vector2d::Zero();  ///< decoded - expected
    double epipolar_px = 0;
};

/// One standard deviation along the worst direction of a covariance.
double worst_sigma(const Eigen::Matrix3d& covariance);

/// By its distance from the projector.
bool in_volume(const CameraModel& projector, const Eigen::Vector3d& p_in_rig, const TriangulationSettings& settings);

/// The strides of settings, or those that make at most 75,000 points of this many pixels.
Stride stride_for(std::size_t decoded, const TriangulationSettings& settings);

/// Adds the outcomes to the result: points, counts and the evidence about the calibration.
void collect(const std::vector<PointOutcome>& outcomes, Triangulation& result);

/// Throws std::invalid_argument when the views or the rig cannot be triangulated.
void check_views(const DecodedView& left, const DecodedView& right, const RigCalibration& rig);

/// The views code columns only: along the epipolar lines (see triangulate).
Triangulation triangulate_columns(const DecodedView& left, const DecodedView& right, const RigCalibration& rig,
                                  const TriangulationSettings& settings);

}  // namespace planlight
