#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "registration/scan/triangulate/triangulate.h"

namespace planlight {

/// Of the projector's placing by points that both cameras saw.
struct ResectionSettings {
    bool free_intrinsics =
        false;  ///< also principal point and focal length (9 instead of 6 numbers): needs depth in the scene
    double max_epipolar_px = 0.5;  ///< of the points used
    std::size_t min_points = 500;
    double min_spread =
        0.10;  ///< of the points in the projector's picture: standard deviation by its width, either way

    // What makes a resection believable.
    double max_rms_after_px = 0.35;
    double min_gain_px = 0.03;  ///< rms before less rms after: less is not worth a change
    double max_moved_mm = 10;   ///< of the projector's centre; more is a projector that was moved: ask, do not absorb
    double max_turned = 0.035;  ///< radians (2 degrees)
};

/// Where the projector stands according to the scan itself.
struct Resection {
    CameraModel projector;  ///< corrected
    double rms_before_px = 0,
           rms_after_px = 0;          ///< decoded - expected, per axis, over the points used (robust weights)
    double moved_mm = 0, turned = 0;  ///< of the projector's centre; of its axes, radians
    std::size_t points = 0;
    bool believable = false;  ///< better than before, good, and near enough to be drift
};

/// Finds the projector from the points that the cameras placed without it and the pixels that lit them: every scan is a
/// free recalibration of the projector against the cameras. It trusts the cameras: an error of theirs that keeps their
/// epipolar lines in place goes into the projector, so `moved_mm` and `turned` are to be watched from scan to scan.
/// Gauss-Newton with Huber weights. Empty when there are too few points, too close together.
std::optional<Resection> resect_projector(const Triangulation& raw, const RigCalibration& rig,
                                          const ResectionSettings& settings = {});

}  // namespace planlight
