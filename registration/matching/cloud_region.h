#pragma once

#include <vector>

#include "planning_io/types/camera_model.h"
#include "planning_io/types/point_cloud.h"

namespace planlight {

/// What of a scan lies within an outline that a person drew on a camera's picture: the last help where cloth and hands
/// hide too much.
///
/// `outline_px`: corners in that camera's pixels, at least three; two are opposite corners of an upright rectangle. An
/// outline that crosses itself counts even-odd. All columns of the cloud are kept for the points within; points behind
/// the camera are outside.
PointCloud within_outline(const PointCloud& cloud, const CameraModel& camera, std::vector<Eigen::Vector2d> outline_px);

}  // namespace planlight
