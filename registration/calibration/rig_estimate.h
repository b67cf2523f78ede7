#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/camera_model.h"
#include "registration/calibration/board_spec.h"
#include "registration/calibration/observe_pose.h"

namespace planlight {

/// As they are numbered wherever an array is by device.
enum class DeviceName { left_camera, right_camera, projector };
inline constexpr std::array kDevices{DeviceName::left_camera, DeviceName::right_camera, DeviceName::projector};
inline constexpr std::array kCameras{DeviceName::left_camera, DeviceName::right_camera};
const char* text_of(DeviceName device);

/// What a calibration finds. The rig frame is that of the left camera (the only camera, where there is one).
struct RigEstimate {
    std::array<std::optional<CameraModel>, 3> devices;          ///< by DeviceName; empty: there is no such device
    std::vector<std::optional<RigidTransform>> rig_from_board;  ///< by pose; empty: the board was not seen
    Eigen::Vector3d bend_mm = Eigen::Vector3d::Zero();          ///< of the board: see `bent`

    const std::optional<CameraModel>& device(DeviceName name) const { return devices[static_cast<std::size_t>(name)]; }
    std::optional<CameraModel>& device(DeviceName name) { return devices[static_cast<std::size_t>(name)]; }
    std::size_t poses() const;
};

/// A board point on the bent board: z = (xx, xy, yy) . bend_mm with x and y from the board's middle in half diagonals.
Eigen::Vector3d bent(const Eigen::Vector3d& flat_in_board, const Eigen::Vector3d& bend_mm, const BoardSpec& board);

/// Where a camera pixel meets the bent board, in board; empty when it does not.
std::optional<Eigen::Vector3d> board_point(const CameraModel& camera, const Eigen::Vector2d& pixel,
                                           const RigidTransform& rig_from_board, const Eigen::Vector3d& bend_mm,
                                           const BoardSpec& board);

/// The numbers of a rig that a calibration determines, and back: per device fx, fy, cx, cy, k1, k2, p1, p2, k3, then
/// (but not for the left camera, whose frame it is) the rotation vector and the shift of device_from_rig.
Eigen::VectorXd numbers_of(const RigEstimate& rig);

/// `rig` with its numbers replaced; the inverse of `numbers_of`.
RigEstimate with_numbers(const RigEstimate& rig, const Eigen::VectorXd& numbers);

inline const CameraObservation& view_of(const PoseObservation& pose, DeviceName camera) {
    return camera == DeviceName::left_camera ? pose.left : pose.right;
}

}  // namespace planlight
