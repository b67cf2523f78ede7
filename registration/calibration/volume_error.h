#pragma once

#include <optional>
#include <vector>

#include "registration/calibration/bundle_adjustment.h"

namespace planlight {

/// Pixels of one point in the devices that see it (empty: it does not), by DeviceName.
using PixelsOfPoint = std::array<std::optional<Eigen::Vector2d>, 3>;

/// The point that fits the pixels best (weights: `sigma_px` of each device), rig frame, mm, by Gauss-Newton from
/// `near`. Empty when under two devices see it, or it does not settle.
std::optional<Eigen::Vector3d> triangulate_pixels(const RigEstimate& rig, const PixelsOfPoint& pixels,
                                                  const std::array<double, 3>& sigma_px, const Eigen::Vector3d& near);

/// Weights of the devices in a scan: as `TriangulationSettings` has them.
inline constexpr std::array<double, 3> kScanSigma_px{0.1, 0.1, 0.25};

/// What the rig's own uncertainty does to a scan. Points of a grid over the working volume (the box in which the boards
/// were, along the axes of the projector, or of the left camera where there is none) that two devices see.
struct VolumeError {
    std::array<int, 3> grid{};            ///< points across, down, deep; all of them are in the lists
    std::vector<Eigen::Vector3d> points;  ///< rig, mm
    std::vector<bool> seen;               ///< by two devices at least
    /// One standard deviation, mm, of a scanned point's place; a common turn and shift of all (which cancels out
    /// between scan and light) is taken away. NaN where not seen.
    std::vector<double> sigma_mm;
    std::vector<double> light_sigma_mm;  ///< of where light lands that is sent to a point two cameras saw; may be empty
    double median_mm = 0, p95_mm = 0, worst_mm = 0, light_p95_mm = 0;
};

/// Empty where there are under two devices.
std::optional<VolumeError> predict_volume_error(const BundleResult& calibration, const BoardSpec& board);

}  // namespace planlight
