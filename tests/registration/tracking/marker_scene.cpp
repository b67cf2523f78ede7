#include "marker_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace planlight::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

cv::Matx33d camera_matrix(const CameraModel& c) {
    return {c.focal_x, 0, c.centre_x, 0, c.focal_y, c.centre_y, 0, 0, 1};
}
cv::Vec<double, 5> distortion(const CameraModel& c) {
    return {c.k1, c.k2, c.p1, c.p2, c.k3};
}

CameraModel camera(int width, int height, double focal) {
    CameraModel c;
    c.width = width, c.height = height;
    c.focal_x = focal, c.focal_y = focal * 1.002;
    c.centre_x = 0.5 * width + 3.7, c.centre_y = 0.5 * height - 5.3;
    c.k1 = -0.22, c.k2 = 0.15, c.p1 = 4e-4, c.p2 = -3e-4;
    return c;
}

/// Looks from `eye` at `target`, both in rig; the rig's y points down as the camera's.
RigidTransform looking(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
    const Eigen::Vector3d z = (target - eye).normalized();
    const Eigen::Vector3d x = Eigen::Vector3d::UnitY().cross(z).normalized();
    RigidTransform device_from_rig;
    device_from_rig.linear() << x.transpose(), z.cross(x).transpose(), z.transpose();
    device_from_rig.translation() = -(device_from_rig.linear() * eye);
    return device_from_rig;
}

RigCalibration rig_of(CameraModel one) {
    RigCalibration rig;
    rig.left_camera = rig.right_camera = one;
    rig.left_camera.device_from_rig = looking({-225, 0, 0}, {0, 0, 870});
    rig.right_camera.device_from_rig = looking({225, 0, 0}, {0, 0, 870});
    rig.right_camera.centre_x -= 6;
    rig.right_camera.k1 = -0.2;
    return rig;
}

/// What a ray from `eye` along `d` meets: black, white, or -1 for the skin behind.
double sticker_grey(const Sticker& s, const Eigen::Vector3d& eye, const Eigen::Vector3d& d, const Look& look) {
    const double t = s.normal.dot(s.centre - eye) / s.normal.dot(d);
    const double r = (eye + t * d - s.centre).norm();
    if (r > s.sticker_radius_mm) return -1;
    if (s.covered) return look.skin * 0.8;
    return r < s.disc_radius_mm ? look.black : look.white;
}

}  // namespace

Eigen::Vector2d seen_at(const CameraModel& camera, const Eigen::Vector3d& p_in_rig) {
    const Eigen::Vector3d p = camera.device_from_rig * p_in_rig;
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}}, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0),
                      camera_matrix(camera), distortion(camera), pixels);
    return {pixels[0].x, pixels[0].y};
}

GrayImage render(const CameraModel& camera, const std::vector<Sticker>& stickers_in_rig, const Look& look,
                 std::mt19937& random) {
    cv::Mat picture(camera.height, camera.width, CV_32F);
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            const double from_middle = std::hypot(x - camera.centre_x, (y - camera.centre_y) * 1.1) / camera.height;
            double grey = from_middle < 0.55 ? look.skin : 12;
            if (look.stray_lines && from_middle < 0.55 && (x * 2 + y) % (camera.height / 6) < 5) grey += 110;
            picture.at<float>(y, x) = static_cast<float>(grey);
        }
    }
    const RigidTransform rig_from_camera = camera.device_from_rig.inverse();
    const Eigen::Vector3d eye = rig_from_camera.translation();
    for (const Sticker& s : stickers_in_rig) {
        if (s.normal.dot(eye - s.centre) <= 0.1 * (eye - s.centre).norm()) continue;
        const Eigen::Vector2d middle = seen_at(camera, s.centre);
        const double reach = 1.15 * s.sticker_radius_mm * camera.focal_x / (camera.device_from_rig * s.centre).z();
        for (int y = static_cast<int>(middle.y() - reach); y <= static_cast<int>(middle.y() + reach); ++y) {
            for (int x = static_cast<int>(middle.x() - reach); x <= static_cast<int>(middle.x() + reach); ++x) {
                if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
                constexpr int kSub = 6;
                std::vector<cv::Point2d> places, rays;
                for (int k = 0; k < kSub * kSub; ++k)
                    places.emplace_back(x + (k % kSub + 0.5) / kSub - 0.5, y + (k / kSub + 0.5) / kSub - 0.5);
                cv::undistortPoints(places, rays, camera_matrix(camera), distortion(camera), cv::noArray(),
                                    cv::noArray(),
                                    cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 1e-9));
                double sum = 0;
                for (const auto& ray : rays) {
                    const Eigen::Vector3d d = rig_from_camera.linear() * Eigen::Vector3d(ray.x, ray.y, 1);
                    const double grey = sticker_grey(s, eye, d, look);
                    sum += grey < 0 ? picture.at<float>(y, x) : grey;
                }
                picture.at<float>(y, x) = static_cast<float>(sum / (kSub * kSub));
            }
        }
    }
    if (look.blur_px > 0) cv::GaussianBlur(picture, picture, {0, 0}, look.blur_px);
    std::normal_distribution<double> noise(0, look.noise);
    GrayImage result(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            const double light = look.light * std::max(0.1, 1 + look.shading_per_px * (x - 0.5 * camera.width));
            const double grey = light * picture.at<float>(y, x) + (look.noise > 0 ? noise(random) : 0);
            result.at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
        }
    return result;
}

CameraModel paper_camera() {
    return camera(744, 576, 2090);
}
CameraModel modern_camera() {
    return camera(1920, 1200, 5080);
}
RigCalibration paper_rig() {
    return rig_of(paper_camera());
}
RigCalibration modern_rig() {
    return rig_of(modern_camera());
}

std::vector<Sticker> stickers_on_head() {
    std::vector<Sticker> stickers;
    for (const Eigen::Vector2d& deg : {Eigen::Vector2d(-38, -25), Eigen::Vector2d(5, -42), Eigen::Vector2d(33, -18),
                                       Eigen::Vector2d(-20, 14), Eigen::Vector2d(24, 26), Eigen::Vector2d(-2, -8)}) {
        const double a = deg.x() * kDegree, b = deg.y() * kDegree;
        const Eigen::Vector3d normal(std::sin(a) * std::cos(b), std::sin(b), -std::cos(a) * std::cos(b));
        stickers.push_back({80 * normal, normal});
    }
    return stickers;
}

Eigen::Vector3d head_centre() {
    return {4, -3, 950};
}

std::vector<Sticker> moved(const RigidTransform& b_from_a, std::vector<Sticker> stickers) {
    for (Sticker& s : stickers) s.centre = b_from_a * s.centre, s.normal = b_from_a.linear() * s.normal;
    return stickers;
}

StereoFrame render_frame(const RigCalibration& rig, const std::vector<Sticker>& stickers_in_rig, const Look& look,
                         Instant at, std::mt19937& random) {
    StereoFrame frame;
    frame.left = render(rig.left_camera, stickers_in_rig, look, random);
    frame.right = render(rig.right_camera, stickers_in_rig, look, random);
    frame.at = at;
    return frame;
}

RigidTransform head_move(const Eigen::Vector3d& turn_deg, const Eigen::Vector3d& shift_mm) {
    Eigen::Matrix<double, 6, 1> twist;
    twist << turn_deg * kDegree, shift_mm;
    return Eigen::Translation3d(head_centre()) * transform_from_twist(twist) * Eigen::Translation3d(-head_centre());
}

}  // namespace planlight::test
