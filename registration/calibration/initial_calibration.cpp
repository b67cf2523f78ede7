#include "registration/calibration/initial_calibration.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "planning_io/types/statistics.h"
#include "registration/calibration/board_turns.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix34 = Eigen::Matrix<double, 3, 4>;

RigidTransform transform_of(const cv::Mat& turn, const cv::Mat& shift) {
    cv::Mat rotation;
    cv::Rodrigues(turn, rotation);
    RigidTransform t = RigidTransform::Identity();
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) t.linear()(r, c) = rotation.at<double>(r, c);
        t.translation()[r] = shift.at<double>(r);
    }
    return t;
}

struct Zhang {
    CameraModel camera;
    std::vector<std::optional<RigidTransform>> camera_from_board;
};

std::optional<Zhang> calibrate_camera(const std::vector<PoseObservation>& poses, DeviceName name,
                                      const BoardSpec& board) {
    std::vector<std::vector<cv::Point3f>> objects;
    std::vector<std::vector<cv::Point2f>> pictures;
    std::vector<std::size_t> which;
    Zhang found;
    found.camera_from_board.resize(poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const CameraObservation& seen = view_of(poses[i], name);
        if (seen.corners.size() < 6) continue;
        found.camera.width = seen.width;
        found.camera.height = seen.height;
        which.push_back(i);
        objects.emplace_back();
        pictures.emplace_back();
        for (std::size_t c = 0; c < seen.corners.size(); ++c) {
            const Vector3d p = board.corner_in_board(seen.corners.ids[c]);
            objects.back().emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
            pictures.back().emplace_back(static_cast<float>(seen.corners.pixels[c].x()),
                                         static_cast<float>(seen.corners.pixels[c].y()));
        }
    }
    if (objects.size() < 3) return std::nullopt;
    cv::Mat matrix = cv::Mat::eye(3, 3, CV_64F), distortion = cv::Mat::zeros(5, 1, CV_64F);
    std::vector<cv::Mat> turns, shifts;
    try {
        cv::calibrateCamera(objects, pictures, {found.camera.width, found.camera.height}, matrix, distortion, turns,
                            shifts,
                            cv::CALIB_FIX_ASPECT_RATIO | cv::CALIB_ZERO_TANGENT_DIST | cv::CALIB_FIX_K2 |
                                cv::CALIB_FIX_K3 | cv::CALIB_FIX_PRINCIPAL_POINT);
    } catch (const cv::Exception&) {
        return std::nullopt;
    }
    found.camera.focal_x = matrix.at<double>(0, 0);
    found.camera.focal_y = matrix.at<double>(1, 1);
    found.camera.centre_x = matrix.at<double>(0, 2);
    found.camera.centre_y = matrix.at<double>(1, 2);
    found.camera.k1 = distortion.at<double>(0);
    if (!std::isfinite(found.camera.focal_x) || !(found.camera.focal_x > 0)) return std::nullopt;
    for (std::size_t i = 0; i < which.size(); ++i)
        found.camera_from_board[which[i]] = transform_of(turns[i], shifts[i]);
    return found;
}

/// Of the transforms that single poses suggest, the one nearest to all others.
std::optional<RigidTransform> middle_of(const std::vector<RigidTransform>& suggested) {
    std::optional<RigidTransform> best;
    double least = std::numeric_limits<double>::max();
    for (const RigidTransform& a : suggested) {
        double sum = 0;
        for (const RigidTransform& b : suggested)
            sum +=
                std::min(0.2, angle_between(a, b)) + std::min(0.2, (a.translation() - b.translation()).norm() / 1000);
        if (sum < least) {
            least = sum;
            best = a;
        }
    }
    return best;
}

Eigen::Matrix<double, 12, 1> smallest_vector(const Eigen::MatrixXd& rows) {
    const Eigen::Matrix<double, 12, 12> square = rows.transpose() * rows;
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>>(square).eigenvectors().col(0);
}

/// RQ decomposition of a 3x3 matrix of positive determinant into K (upper triangular, positive diagonal, K(2,2) = 1)
/// and a rotation R (Hartley & Zisserman, A4.1.1).
void rq_decomposition(const Matrix3d& m, Matrix3d& K, Matrix3d& R) {
    cv::Matx33d matrix, upper, rotation;
    cv::eigen2cv(m, matrix);
    cv::RQDecomp3x3(matrix, upper, rotation);
    cv::cv2eigen(upper, K);
    cv::cv2eigen(rotation, R);
    K /= K(2, 2);
}

}  // namespace

std::optional<Matrix34> linear_projection(const std::vector<Vector3d>& points, const std::vector<Vector2d>& pixels) {
    std::vector<std::size_t> used(points.size());
    for (std::size_t i = 0; i < used.size(); ++i) used[i] = i;
    Matrix34 P;
    for (int round = 0; round < 4; ++round) {
        if (used.size() < 30) return std::nullopt;
        Vector3d middle = Vector3d::Zero();
        Vector2d pixel_middle = Vector2d::Zero();
        for (const std::size_t i : used) {
            middle += points[i] / static_cast<double>(used.size());
            pixel_middle += pixels[i] / static_cast<double>(used.size());
        }
        double spread = 1e-9, pixel_spread = 1e-9;
        for (const std::size_t i : used) {
            spread += (points[i] - middle).norm() / static_cast<double>(used.size());
            pixel_spread += (pixels[i] - pixel_middle).norm() / static_cast<double>(used.size());
        }
        Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * static_cast<Eigen::Index>(used.size()), 12);
        for (std::size_t k = 0; k < used.size(); ++k) {
            const Eigen::RowVector4d p = ((points[used[k]] - middle) / spread).homogeneous().transpose();
            const Vector2d u = (pixels[used[k]] - pixel_middle) / pixel_spread;
            const auto r = 2 * static_cast<Eigen::Index>(k);
            rows.row(r) << p, Eigen::RowVector4d::Zero(), -u.x() * p;
            rows.row(r + 1) << Eigen::RowVector4d::Zero(), p, -u.y() * p;
        }
        const auto v = smallest_vector(rows);
        Matrix34 normal;
        normal << v.segment<4>(0).transpose(), v.segment<4>(4).transpose(), v.segment<4>(8).transpose();
        Eigen::Matrix4d shrink = Eigen::Matrix4d::Identity();
        shrink.topLeftCorner<3, 3>() /= spread;
        shrink.topRightCorner<3, 1>() = -middle / spread;
        Matrix3d grow = Vector3d(pixel_spread, pixel_spread, 1).asDiagonal();
        grow.topRightCorner<2, 1>() = pixel_middle;
        P = grow * normal * shrink;
        if (!P.allFinite() || std::abs(P.leftCols<3>().determinant()) < 1e-300) return std::nullopt;

        std::vector<std::pair<double, std::size_t>> off;
        for (std::size_t i = 0; i < points.size(); ++i)
            off.push_back({((P * points[i].homogeneous()).hnormalized() - pixels[i]).norm(), i});
        std::sort(off.begin(), off.end());
        const double limit = std::max(2.0, 4 * off[off.size() / 2].first);
        used.clear();
        for (const auto& [distance, i] : off)
            if (distance < limit) used.push_back(i);
    }
    return P;
}

std::optional<RigidTransform> board_pose(const CameraModel& camera, const BoardCorners& corners,
                                         const BoardSpec& board) {
    if (corners.size() < 6) return std::nullopt;
    std::vector<cv::Point3d> object;
    std::vector<cv::Point2d> picture;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector3d p = board.corner_in_board(corners.ids[i]);
        object.emplace_back(p.x(), p.y(), 0);
        picture.emplace_back(corners.pixels[i].x(), corners.pixels[i].y());
    }
    cv::Mat turn, shift;
    const cv::Matx33d matrix(camera.focal_x, 0, camera.centre_x, 0, camera.focal_y, camera.centre_y, 0, 0, 1);
    if (!cv::solvePnP(object, picture, matrix,
                      std::vector<double>{camera.k1, camera.k2, camera.p1, camera.p2, camera.k3}, turn, shift))
        return std::nullopt;
    return camera.device_from_rig.inverse() * transform_of(turn, shift);
}

std::optional<double> misfit_anywhere(const CameraModel& device, const std::vector<Vector3d>& points_in_rig,
                                      const std::vector<Vector2d>& pixels) {
    const cv::Matx33d matrix(device.focal_x, 0, device.centre_x, 0, device.focal_y, device.centre_y, 0, 0, 1);
    const std::vector<double> distortion{device.k1, device.k2, device.p1, device.p2, device.k3};
    std::vector<cv::Point3d> object;
    std::vector<cv::Point2d> picture;
    for (std::size_t i = 0; i < points_in_rig.size(); ++i) {
        const Vector3d p = device.device_from_rig * points_in_rig[i];
        object.emplace_back(p.x(), p.y(), p.z());
        picture.emplace_back(pixels[i].x(), pixels[i].y());
    }
    std::vector<double> lengths;
    for (int round = 0; round < 2; ++round) {
        if (object.size() < 30) return std::nullopt;
        cv::Mat turn = cv::Mat::zeros(3, 1, CV_64F), shift = cv::Mat::zeros(3, 1, CV_64F);
        if (!cv::solvePnP(object, picture, matrix, distortion, turn, shift, true)) return std::nullopt;
        std::vector<cv::Point2d> expected;
        cv::projectPoints(object, turn, shift, matrix, distortion, expected);
        lengths.clear();
        for (std::size_t i = 0; i < expected.size(); ++i)
            lengths.push_back(std::hypot(expected[i].x - picture[i].x, expected[i].y - picture[i].y));
        const double limit = 4 * median(lengths);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < lengths.size(); ++i)
            if (lengths[i] <= limit) object[kept] = object[i], picture[kept] = picture[i], lengths[kept++] = lengths[i];
        object.resize(kept);
        picture.resize(kept);
        lengths.resize(kept);
    }
    double square = 0;
    for (const double length : lengths) square += length * length;
    return lengths.size() < 30 ? std::nullopt : std::optional(std::sqrt(square / static_cast<double>(lengths.size())));
}

std::vector<PoseObservation> named_as_left(std::vector<PoseObservation> poses, const BoardSpec& board) {
    if (board.has_a_top()) return poses;
    const auto left = calibrate_camera(poses, DeviceName::left_camera, board),
               right = calibrate_camera(poses, DeviceName::right_camera, board);
    if (!left || !right) return poses;
    const std::vector<BoardTurn> turns = turns_of(board);
    std::vector<RigidTransform> suggested;
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (!left->camera_from_board[i] || !right->camera_from_board[i]) continue;
        which.push_back(i);
        for (const BoardTurn& turn : turns)
            suggested.push_back(*right->camera_from_board[i] * turn.to_from.inverse() *
                                left->camera_from_board[i]->inverse());
    }
    const auto right_from_left = middle_of(suggested);
    for (std::size_t k = 0; k < which.size(); ++k) {
        std::size_t nearest = 0;
        for (std::size_t t = 1; t < turns.size(); ++t)
            if (angle_between(suggested[k * turns.size() + t], *right_from_left) <
                angle_between(suggested[k * turns.size() + nearest], *right_from_left))
                nearest = t;
        rename(poses[which[k]].right.corners, turns[nearest]);
    }
    return poses;
}

InitialCalibration calibrate_cameras_initially(const std::vector<PoseObservation>& poses, const BoardSpec& board) {
    InitialCalibration start;
    const auto left = calibrate_camera(poses, DeviceName::left_camera, board);
    if (!left) {
        start.failure = "the left camera's pictures do not determine the camera";
        return start;
    }
    start.rig.device(DeviceName::left_camera) = left->camera;
    start.rig.rig_from_board = left->camera_from_board;
    const bool has_right =
        std::any_of(poses.begin(), poses.end(), [](const PoseObservation& p) { return p.right.width > 0; });
    if (has_right) {
        auto right = calibrate_camera(poses, DeviceName::right_camera, board);
        std::vector<RigidTransform> suggested;
        if (right)
            for (std::size_t i = 0; i < poses.size(); ++i)
                if (right->camera_from_board[i] && left->camera_from_board[i])
                    suggested.push_back(*right->camera_from_board[i] * left->camera_from_board[i]->inverse());
        const auto right_from_left = middle_of(suggested);
        if (!right_from_left) {
            start.failure =
                right ? "no pose is seen by both cameras" : "the right camera's pictures do not determine the camera";
            return start;
        }
        right->camera.device_from_rig = *right_from_left;
        start.rig.device(DeviceName::right_camera) = right->camera;
        for (std::size_t i = 0; i < poses.size(); ++i)
            if (!start.rig.rig_from_board[i] && right->camera_from_board[i])
                start.rig.rig_from_board[i] = right_from_left->inverse() * *right->camera_from_board[i];
    }
    return start;
}

void add_initial_projector(const std::vector<PoseObservation>& poses, const BoardSpec& board, int width, int height,
                           InitialCalibration& start) {
    std::vector<Vector3d> points;
    std::vector<Vector2d> pixels;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (!start.rig.rig_from_board[i]) continue;
        for (const DeviceName name : {DeviceName::left_camera, DeviceName::right_camera}) {
            if (!start.rig.device(name)) continue;
            for (const LightSample& sample : view_of(poses[i], name).light)
                if (const auto p = board_point(*start.rig.device(name), sample.pixel_in_camera,
                                               *start.rig.rig_from_board[i], Vector3d::Zero(), board)) {
                    points.push_back(*start.rig.rig_from_board[i] * *p);
                    pixels.push_back(sample.pixel_in_projector);
                }
        }
    }
    const auto P = linear_projection(points, pixels);
    if (!P) {
        start.failure =
            fmt::format("the projector's light was decoded at {} places on the board, too few to find the projector",
                        points.size());
        return;
    }
    const Matrix34 positive = P->leftCols<3>().determinant() > 0 ? *P : Matrix34(-*P);
    std::size_t behind = 0;
    for (const Vector3d& p : points) behind += positive.row(2).dot(p.homogeneous()) < 0;
    start.projector_mirrored = 2 * behind > points.size();
    Matrix3d K, R;
    rq_decomposition(positive.leftCols<3>(), K, R);
    CameraModel projector;
    projector.width = width;
    projector.height = height;
    projector.focal_x = K(0, 0);
    projector.focal_y = K(1, 1);
    projector.centre_x = K(0, 2);
    projector.centre_y = K(1, 2);
    projector.device_from_rig.linear() = R;
    const Vector3d centre = -positive.leftCols<3>().inverse() * positive.col(3);
    projector.device_from_rig.translation() = -R * centre;
    start.rig.device(DeviceName::projector) = projector;
}

}  // namespace planlight
