#include "tests/registration/calibration/ideal_board.h"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "tests/registration/opencv_pixel.h"

namespace planlight::test {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

bool inside(const CameraModel& d, const Vector2d& p) {
    return p.x() > 2 && p.y() > 2 && p.x() < d.width - 3 && p.y() < d.height - 3;
}

CameraModel device(int width, int height, double focal, double centre_x, double centre_y, const Vector3d& eye,
                   const Vector3d& target) {
    CameraModel d;
    d.width = width;
    d.height = height;
    d.focal_x = d.focal_y = focal;
    d.centre_x = centre_x;
    d.centre_y = centre_y;
    const Vector3d z = (target - eye).normalized(), x = Vector3d::UnitY().cross(z).normalized();
    RigidTransform rig_from_device = RigidTransform::Identity();
    rig_from_device.linear() << x, z.cross(x), z;
    rig_from_device.translation() = eye;
    d.device_from_rig = rig_from_device.inverse();
    return d;
}

/// Pixels of the camera that look at the board, and what lights them.
void light_up(const IdealRoom& room, const CameraModel& camera, const RigidTransform& rig_from_board,
              std::mt19937& random, CameraObservation& seen) {
    std::normal_distribution<double> noise(0, room.light_noise_px);
    const RigidTransform board_from_camera = rig_from_board.inverse() * camera.device_from_rig.inverse();
    for (int y = 4; y < camera.height; y += 25)
        for (int x = 4; x < camera.width; x += 25) {
            std::vector<cv::Point2d> normal;
            cv::undistortPoints(
                std::vector<cv::Point2d>{{static_cast<double>(x), static_cast<double>(y)}}, normal,
                cv::Matx33d(camera.focal_x, 0, camera.centre_x, 0, camera.focal_y, camera.centre_y, 0, 0, 1),
                std::vector<double>{camera.k1, camera.k2, camera.p1, camera.p2, camera.k3}, cv::noArray(),
                cv::noArray(), {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-12});
            const Vector3d origin = board_from_camera.translation(),
                           way = board_from_camera.linear() * Vector3d(normal[0].x, normal[0].y, 1);
            const Vector3d p = origin - way * (origin.z() / way.z());
            if (p.x() < 2 || p.y() < 2 || p.x() > room.board.width_mm() - 2 || p.y() > room.board.height_mm() - 2)
                continue;
            const Vector2d lit = opencv_pixel(room.rig.projector, rig_from_board * p);
            if (inside(room.rig.projector, lit))
                seen.light.push_back({{x, y}, lit + Vector2d(noise(random), noise(random))});
        }
}

}  // namespace

std::vector<PoseObservation> IdealRoom::observe(unsigned seed) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, noise_px);
    std::vector<PoseObservation> poses;
    for (std::size_t i = 0; i < rig_from_board.size(); ++i) {
        PoseObservation pose;
        pose.name = fmt::format("pose-{:02}", i);
        for (const bool right : {false, true}) {
            const CameraModel& camera = right ? rig.right_camera : rig.left_camera;
            CameraObservation& seen = right ? pose.right : pose.left;
            seen.width = camera.width;
            seen.height = camera.height;
            seen.coded_light = true;
            seen.white_grey = 120;
            seen.contrast_grey = 80;
            seen.decoded_share = 1;
            for (int id = 0; id < board.corner_count(); ++id) {
                const Vector2d pixel = opencv_pixel(camera, rig_from_board[i] * board.corner_in_board(id));
                if (!inside(camera, pixel)) continue;
                seen.corners.ids.push_back(id);
                seen.corners.pixels.push_back(pixel + Vector2d(noise(random), noise(random)));
            }
            light_up(*this, camera, rig_from_board[i], random, seen);
        }
        poses.push_back(std::move(pose));
    }
    return poses;
}

IdealRoom ideal_room(int poses, double tilt_deg, const char* board) {
    IdealRoom room;
    room.board = parse_board(board);
    const Vector3d target(0, 0, 900);
    room.rig.left_camera = device(744, 576, 2180, 368, 290, {-220, 30, 0}, target);
    room.rig.right_camera = device(744, 576, 2185, 375, 286, {230, 25, 10}, target);
    room.rig.projector = device(800, 600, 2215, 405, 580, {5, 115, 10}, {5, 115, 900});
    room.rig.left_camera.k1 = -0.15;
    room.rig.right_camera.k1 = -0.18;
    room.rig.projector.k1 = -0.03;
    for (int i = 0; i < poses; ++i) {
        const double way = 2 * M_PI * i / poses + 0.3, tilt = tilt_deg * M_PI / 180;
        RigidTransform pose = RigidTransform::Identity();
        pose.linear() = (Eigen::AngleAxisd(tilt, Vector3d(std::cos(way), std::sin(way), 0)) *
                         Eigen::AngleAxisd(0.7 * i, Vector3d::UnitZ()))
                            .toRotationMatrix();
        pose.translation() = target + Vector3d(20 * std::cos(3.0 * i), 15 * std::sin(2.0 * i), i % 2 ? 45 : -45) -
                             pose.linear() * Vector3d(room.board.width_mm() / 2, room.board.height_mm() / 2, 0);
        room.rig_from_board.push_back(pose);
    }
    return room;
}

}  // namespace planlight::test
