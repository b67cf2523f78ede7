#pragma once

#include <cstddef>
#include <vector>

#include "registration/scan/scan_surface.h"
#include "registration/simulation/simulated_rig.h"

// What a scan is worth against the simulator's truth.
namespace planlight::scan_rooms {

struct CloudFigures {
    std::size_t points = 0;
    double noise_mm = 0;  ///< rms of the distance to the true skin about its own mean in cubes of 4 mm, of skin that
                          ///< faces the projector at less than 65 degrees, off the stickers
    double noise_all_mm = 0;    ///< the same of all points
    double noise_usual_mm = 0;  ///< the same from the median of its size (of a normal distribution): without the tails
    double bias_mm = 0;         ///< mean signed distance, positive outside
    double slow_mm = 0;         ///< rms of the means of the cubes: what calibration and the light in the skin bend
    double completeness = 0;    ///< see `completeness`
    double chi_square = 0;      ///< mean square of distance / its stated sigma (1: the covariances are right)
    double chi_square_median = 0;  ///< by the median of a chi-square (0.455): without the tails
};
CloudFigures cloud_figures(const ScanResult& scan, const simulation::SimulatedRig& room, const RigCalibration& rig,
                           Instant at);

/// rms of `errors` about their own mean in cubes of 4 mm (those with six points or more).
double scatter_in_cubes_mm(const std::vector<Eigen::Vector3d>& points, const std::vector<double>& errors);

/// Of each point of the cloud: under 65 degrees between its normal and the way to the projector, and off the stickers.
std::vector<bool> facing_points(const PointCloud& cloud, const simulation::SimulatedRig& room,
                                const RigCalibration& rig, Instant at);

/// Share of the true skin that is lit, faces the projector and a camera that sees it at less than 65 degrees, lies off
/// the stickers, and has a point of the cloud within 2 mm. Sampled every few projector pixels.
double completeness(const std::vector<Eigen::Vector3d>& points_in_rig, const simulation::SimulatedRig& room,
                    const RigCalibration& true_rig, Instant at);

struct CodeFigures {
    std::size_t looked_at = 0;     ///< decoded pixels, every second one of every second row
    std::size_t wrong = 0;         ///< more than 2 projector pixels off, or lit by nothing
    std::size_t wrong_inside = 0;  ///< of these: no silhouette, shadow edge or rim of the picture within 3 pixels
    std::size_t wrong_facing = 0;  ///< of these again: on skin that faces camera and projector at less than 65 degrees
};
CodeFigures code_figures(const DecodedView& view, const simulation::SimulatedRig& room,
                         simulation::SimulatedRig::Camera camera, const RigCalibration& true_rig, Instant at);

/// The least-squares sphere through points (Huber beyond 0.2 mm); radius 0 when there is none.
double fitted_radius_mm(const std::vector<Eigen::Vector3d>& points);

}  // namespace planlight::scan_rooms
