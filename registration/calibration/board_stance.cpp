#include "registration/calibration/board_stance.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "registration/calibration/initial_calibration.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kUsualFocal = 1.8, kFocalLeast = 0.4, kFocalMost = 10;  ///< picture widths
/// Of 1 / focal^2 (picture widths) before anything is seen, and of a homography's two equations for it.
constexpr double kPrior = 0.3, kNoise = 1e-3;

/// Board (its own widths, about its middle) to picture (picture widths, about its middle), its last number 1; from the
/// corners by a direct linear transformation.
Matrix3d homography(const BoardCorners& corners, const BoardSpec& board, int width, int height) {
    Eigen::Matrix<double, 9, 9> square = Eigen::Matrix<double, 9, 9>::Zero();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector3d b =
            ((board.corner_in_board(corners.ids[i]).head<2>() - Vector2d(board.width_mm(), board.height_mm()) / 2) /
             board.width_mm())
                .homogeneous();
        const Vector2d p = (corners.pixels[i] - Vector2d(width - 1, height - 1) / 2) / width;
        Eigen::Matrix<double, 2, 9> rows;
        rows << b.transpose(), 0, 0, 0, -p.x() * b.transpose(), 0, 0, 0, b.transpose(), -p.y() * b.transpose();
        square += rows.transpose() * rows;
    }
    const Eigen::Matrix<double, 9, 1> h =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>>(square).eigenvectors().col(0);
    Matrix3d H;
    H << h.segment<3>(0).transpose(), h.segment<3>(3).transpose(), h.segment<3>(6).transpose();
    return H / H(2, 2);
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
    // Zhang 2000, eq. 3 and 4, of a camera of which only the focal length is unknown: linear in 1 / focal^2.
    double top = kNoise * kNoise / (kPrior * kPrior), sum = top / (kUsualFocal * kUsualFocal);
    for (const BoardCorners& corners : views) {
        const Matrix3d H = homography(corners, board, width, height);
        const Vector2d a = H.block<2, 1>(0, 0), b = H.block<2, 1>(0, 1);
        const double by[2] = {a.dot(b), a.dot(a) - b.dot(b)},
                     rest[2] = {H(2, 0) * H(2, 1), H(2, 0) * H(2, 0) - H(2, 1) * H(2, 1)};
        for (int i = 0; i < 2; ++i) {
            top += by[i] * by[i];
            sum -= by[i] * rest[i];
        }
    }
    const double inverse_square = sum / top;
    const double focal = inverse_square > 0 ? 1 / std::sqrt(inverse_square) : kFocalMost;
    camera.focal_x = camera.focal_y = std::clamp(focal, kFocalLeast, kFocalMost) * width;
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
