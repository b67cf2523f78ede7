#include "registration/calibration/board_stance.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "registration/calibration/initial_calibration.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kUsualFocal = 1.8, kUsualSpread = 0.6;  ///< picture widths, and its logarithm's standard deviation
constexpr double kMisfit_px = 0.3;                       ///< that distortion may leave

/// Mean square distance of the corners from where the best pose puts them, px^2.
double misfit(const CameraModel& camera, const BoardCorners& corners, const BoardSpec& board) {
    const auto pose = board_pose(camera, corners, board);
    constexpr double kNone = 1e6;
    if (!pose) return kNone;
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto pixel = project(camera, *pose * board.corner_in_board(corners.ids[i]));
        if (!pixel) return kNone;
        sum += (*pixel - corners.pixels[i]).squaredNorm();
    }
    return sum / static_cast<double>(corners.size());
}

/// Angle between the face and the line of sight to its middle.
double angle_of_view(const RigidTransform& camera_from_board, const Vector3d& middle) {
    const Vector3d sight = (camera_from_board * middle).normalized();
    return std::acos(std::clamp(sight.dot(camera_from_board.linear().col(2)), -1.0, 1.0));
}

}  // namespace

CameraModel guessed_camera(const std::vector<BoardCorners>& views, const BoardSpec& board, int width, int height) {
    CameraModel camera;
    camera.width = width;
    camera.height = height;
    camera.centre_x = (width - 1) / 2.0;
    camera.centre_y = (height - 1) / 2.0;
    double best = kUsualFocal, least = 1e18;
    for (double focal = 0.5; focal < 8; focal *= 1.1) {
        camera.focal_x = camera.focal_y = focal * width;
        const double off = std::log(focal / kUsualFocal) / kUsualSpread;
        double cost = off * off;
        for (const BoardCorners& corners : views) cost += misfit(camera, corners, board) / (kMisfit_px * kMisfit_px);
        if (cost < least) least = cost, best = focal;
    }
    camera.focal_x = camera.focal_y = best * width;
    return camera;
}

std::optional<BoardStance> stance_of(const BoardCorners& left, const BoardCorners& right, const CameraModel& left_lens,
                                     const CameraModel& right_lens, const BoardSpec& board) {
    CameraModel left_camera = left_lens, right_camera = right_lens;
    left_camera.device_from_rig = right_camera.device_from_rig = RigidTransform::Identity();
    const auto in_left = board_pose(left_camera, left, board), in_right = board_pose(right_camera, right, board);
    if (!in_left || !in_right) return std::nullopt;
    BoardStance stance;
    stance.left_from_board = *in_left;
    const Vector3d middle(board.width_mm() / 2, board.height_mm() / 2, 0);
    stance.steepest = std::max(angle_of_view(*in_left, middle), angle_of_view(*in_right, middle));
    stance.distance_mm = ((*in_left * middle).norm() + (*in_right * middle).norm()) / 2;
    // The right camera's direction of view in the left one's frame, by the board that both see.
    const Vector3d right_view = in_left->linear() * in_right->linear().transpose() * Vector3d::UnitZ();
    const Vector3d view = (Vector3d::UnitZ() + right_view).normalized();
    const Vector3d face = Eigen::Quaterniond::FromTwoVectors(view, Vector3d::UnitZ()) * -in_left->linear().col(2);
    const double away = std::acos(std::clamp(-face.z(), -1.0, 1.0));
    const double aside = face.head<2>().norm();
    if (aside > 1e-9) stance.tilt = face.head<2>() * (away / aside);
    return stance;
}

}  // namespace planlight
