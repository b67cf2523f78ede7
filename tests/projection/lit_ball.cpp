#include "tests/projection/lit_ball.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <random>

#include "projection/render_drawing.h"
#include "tests/projection/shapes.h"

namespace planlight::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

cv::Mat matrix_of(const CameraModel& m) {
    return (cv::Mat_<double>(3, 3) << m.focal_x, 0, m.centre_x, 0, m.focal_y, m.centre_y, 0, 0, 1);
}
cv::Mat lens_of(const CameraModel& m) {
    return (cv::Mat_<double>(1, 5) << m.k1, m.k2, m.p1, m.p2, m.k3);
}

std::optional<Vector3d> on_ball_along(const Vector3d& origin, const Vector3d& way, double radius_mm) {
    const double b = origin.dot(way), root = b * b - origin.squaredNorm() + radius_mm * radius_mm;
    if (root < 0) return std::nullopt;
    return Vector3d(origin + (-b - std::sqrt(root)) * way);
}

/// Where the sight meets the skin, with what it is higher there.
std::optional<Vector3d> on_skin_along(const Vector3d& origin, const Vector3d& way, const LitBall& settings) {
    constexpr double kWhole_mm = 10, kNone_mm = 22;
    auto p = on_ball_along(origin, way, kBallRadius_mm + settings.plate_mm);
    for (int round = 0; p && settings.swollen && round < 12; ++round) {
        const double from_mm = (kBallRadius_mm * p->normalized() - *settings.swollen).norm();
        const double share = std::clamp((kNone_mm - from_mm) / (kNone_mm - kWhole_mm), 0.0, 1.0);
        p = on_ball_along(origin, way, kBallRadius_mm + settings.plate_mm + share * settings.swollen_mm);
    }
    return p;
}

/// Spots and lines that come back nowhere, darker than the skin.
double texture_at(const Vector3d& p) {
    const double spots = std::sin(1.9 * p.x() + 2.3 * std::sin(0.7 * p.z())) * std::sin(2.3 * p.z() + std::sin(p.y()));
    const double hair = std::exp(-std::pow(3 * std::sin(0.5 * p.x() + 0.31 * p.z() + 0.4 * std::sin(0.3 * p.z())), 2));
    return std::max(0.0, spots) + hair;
}

GrayImage picture_of(const CameraModel& camera, const RgbImage& light, const RigCalibration& rig,
                     const LitBall& settings, unsigned seed) {
    std::vector<cv::Point2d> pixels, rays;
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) pixels.emplace_back(x, y);
    cv::undistortPoints(pixels, rays, matrix_of(camera), lens_of(camera));
    const RigidTransform rig_from_device = camera.device_from_rig.inverse();
    std::vector<cv::Point3d> lit;
    std::vector<std::size_t> where;
    GrayImage picture(camera.width, camera.height, 8);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, settings.noise_grey);
    std::vector<double> grey(rays.size(), 8);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Vector3d way = (rig_from_device.linear() * Vector3d(rays[i].x, rays[i].y, 1)).normalized();
        const auto p = on_skin_along(rig_from_device.translation(), way, settings);
        if (!p) continue;
        const bool covered = settings.covered && (*p - *settings.covered).norm() < 5;
        grey[i] = covered ? 20 : 60 - settings.texture_grey * texture_at(*p);
        if (covered || p->x() > settings.shaded_from_mm) continue;
        lit.emplace_back(p->x(), p->y(), p->z());
        where.push_back(i);
    }
    const RigidTransform& device = rig.projector.device_from_rig;
    cv::Mat turn(3, 3, CV_64F), rodrigues;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) turn.at<double>(r, c) = device.linear()(r, c);
    cv::Rodrigues(turn, rodrigues);
    const Vector3d t = device.translation();
    std::vector<cv::Point2d> in_projector;
    if (!lit.empty())
        cv::projectPoints(lit, rodrigues, cv::Vec3d(t.x(), t.y(), t.z()), matrix_of(rig.projector),
                          lens_of(rig.projector), in_projector);
    for (std::size_t k = 0; k < lit.size() && settings.lit; ++k) {
        const double x = in_projector[k].x - settings.picture_moved_px.x(),
                     y = in_projector[k].y - settings.picture_moved_px.y();
        double sum = 0;  // the projector's own blur, and the cell of a camera's pixel
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const int u = static_cast<int>(std::lround(x)) + dx, v = static_cast<int>(std::lround(y)) + dy;
                if (u < 0 || v < 0 || u >= light.width || v >= light.height) continue;
                sum += light_of_number(*std::max_element(light.at(u, v).begin(), light.at(u, v).end())) / 9;
            }
        grey[where[k]] += 90 * sum;
    }
    for (std::size_t i = 0; i < grey.size(); ++i)
        picture.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(grey[i] + noise(random)), 0L, 255L));
    return picture;
}

}  // namespace

RigCalibration rig_before_ball() {
    const Vector3d target = on_ball(0.3, 0.4), out = target.normalized(), up(0, 0, 1);
    const Vector3d right = up.cross(out).normalized();
    RigCalibration rig;
    rig.projector = projector_looking_at(target, out, 700, up);
    rig.left_camera = projector_looking_at(target, out - 0.25 * right, 720, up);
    rig.right_camera = projector_looking_at(target, out + 0.25 * right + 0.05 * up, 720, up);
    constexpr double kSmaller = 0.6;
    for (CameraModel* camera : {&rig.left_camera, &rig.right_camera}) {
        for (double* length : {&camera->focal_x, &camera->focal_y, &camera->centre_x, &camera->centre_y})
            *length *= kSmaller;
        camera->width = static_cast<int>(kSmaller * camera->width);
        camera->height = static_cast<int>(kSmaller * camera->height);
    }
    return rig;
}

StereoFrame pictures_of(const PlanDrawing& drawing, const RigCalibration& rig, const LitBall& settings) {
    const RgbImage light = DrawingRenderer(ball(), rig.projector).render(drawing, RigidTransform::Identity());
    StereoFrame frame;
    frame.left = picture_of(rig.left_camera, light, rig, settings, 1);
    frame.right = picture_of(rig.right_camera, light, rig, settings, 2);
    return frame;
}

}  // namespace planlight::test
