#pragma once

#include "planning_io/types/camera_model.h"

namespace planlight::test {

/// The third party's opinion: OpenCV's pixel of a point in rig.
Eigen::Vector2d opencv_pixel(const CameraModel& device, const Eigen::Vector3d& p_in_rig);

}  // namespace planlight::test
