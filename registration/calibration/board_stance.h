#pragma once

#include <optional>
#include <vector>

#include "planning_io/types/camera_model.h"
#include "registration/calibration/find_board.h"

namespace planlight {

/// How the board stands before a pair of cameras.
struct BoardStance {
    RigidTransform left_from_board = RigidTransform::Identity();
    /// To where its face is turned away from the two cameras' common direction of view: right and down in the left
    /// picture; its length is the angle, radians. A face turned to the right has its left edge nearer.
    Eigen::Vector2d tilt = Eigen::Vector2d::Zero();
    double steepest = 0;     ///< radians: the larger of the angles at which the cameras look onto it; 0 is straight on
    double distance_mm = 0;  ///< of its middle, mean of both cameras
};

/// A camera of which only pictures of the board are known: square pixels, axis in the middle, no distortion, and the
/// focal length that fits the views best. Views straight on say little of it; then about 1.8 picture widths.
/// `device_from_rig` is the identity.
CameraModel guessed_camera(const std::vector<BoardCorners>& views, const BoardSpec& board, int width, int height);

/// Empty where a camera sees too few corners. Where the cameras stand is not used.
std::optional<BoardStance> stance_of(const BoardCorners& left, const BoardCorners& right, const CameraModel& left_lens,
                                     const CameraModel& right_lens, const BoardSpec& board);

}  // namespace planlight
