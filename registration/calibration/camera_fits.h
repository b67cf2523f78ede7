#pragma once

#include <optional>
#include <vector>

#include "registration/calibration/calibrate_rig.h"

// How well the cameras fit their corners, each alone and both together. Private to the judges of a calibration.
namespace planlight {

inline constexpr double kResidualFloor_px = 0.02;  ///< below this a ratio of residuals says nothing

double share_left_out(const BundleResult& bundle, DeviceName name);
double rms_of(const BundleResult& bundle, DeviceName name);

/// The cameras adjusted on their corners.
BundleResult adjust_corners(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                            const CalibrationSettings& settings);

/// One camera adjusted by itself, as the left one of a rig.
BundleResult camera_alone(const std::vector<PoseObservation>& poses, const BoardSpec& board, DeviceName camera,
                          const CalibrationSettings& settings);

/// Whether both cameras' corners fit within the limits.
bool cameras_fit(const BundleResult& bundle, const CalibrationSettings& settings);

/// A camera that fits its corners by itself, but much worse together with the other.
struct WorseTogether {
    DeviceName camera;
    double by_itself_px, together_px;
};

std::optional<WorseTogether> worse_together(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                            const BundleResult& cameras, const CalibrationSettings& settings);

}  // namespace planlight
