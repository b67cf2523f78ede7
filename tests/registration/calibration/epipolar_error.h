#pragma once

#include <optional>

#include "planning_io/types/rig_calibration.h"

namespace planlight::test {

/// How far, right-camera pixels, the true right pixel of a point lies from the epipolar line that the calibrated
/// cameras draw of its true left pixel: what a calibration's error alone makes of `DriftCheck::epipolar_px`.
/// `p_in_rig` in mm in the frame of the true cameras. Empty: one of the cameras does not see it. (Hartley &
/// Zisserman, 9.1.)
std::optional<double> epipolar_error_px(const CameraModel& true_left, const CameraModel& true_right,
                                        const CameraModel& left, const CameraModel& right,
                                        const Eigen::Vector3d& p_in_rig);

}  // namespace planlight::test
