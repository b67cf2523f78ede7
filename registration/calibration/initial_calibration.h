#pragma once

#include <string>
#include <vector>

#include "registration/calibration/rig_estimate.h"

namespace planlight {

/// A rig that is right to a few pixels, to begin the bundle adjustment with.
struct InitialCalibration {
    RigEstimate rig;
    std::string failure;              ///< not empty: no start was found, and why
    bool projector_mirrored = false;  ///< the lit points fit only a projector whose picture is mirrored
};

/// A chessboard that looks the same when turned by half a turn (a square one: whose corners lie the same by a quarter)
/// has its corners named by where they stand in each picture: a camera that hangs upside down, or a board that lies on
/// its side, has them named from another end. The right camera's names, turned in each pose so that the cameras stand
/// to each other as in most others. Other boards: unchanged.
std::vector<PoseObservation> named_as_left(std::vector<PoseObservation> poses, const BoardSpec& board);

/// Cameras by Zhang 2000 (OpenCV); the right camera from the poses that both see.
InitialCalibration calibrate_cameras_initially(const std::vector<PoseObservation>& poses, const BoardSpec& board);

/// Adds the projector to a start whose cameras are known: an inverse camera with a free principal point, by a direct
/// linear transformation of all lit board points of all poses (Hartley & Zisserman, 7.1).
void add_initial_projector(const std::vector<PoseObservation>& poses, const BoardSpec& board, int width, int height,
                           InitialCalibration& start);

/// Pose of the board before a device that is known, from its corners; empty when there are under 6.
std::optional<RigidTransform> board_pose(const CameraModel& camera, const BoardCorners& corners,
                                         const BoardSpec& board);

/// How well a device's pixels fit points when the device may stand anywhere: root mean square length, pixels, without
/// what is beyond four medians. Empty when under 30 points are left.
std::optional<double> misfit_anywhere(const CameraModel& device, const std::vector<Eigen::Vector3d>& points_in_rig,
                                      const std::vector<Eigen::Vector2d>& pixels);

/// 3x4 matrix with pixel ~ P (point, 1), from six or more points not in one plane; wrong points (a quarter at most) are
/// left out.
std::optional<Eigen::Matrix<double, 3, 4>> linear_projection(const std::vector<Eigen::Vector3d>& points,
                                                             const std::vector<Eigen::Vector2d>& pixels);

}  // namespace planlight
