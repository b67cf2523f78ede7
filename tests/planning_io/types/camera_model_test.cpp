#include "planning_io/types/camera_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <random>

namespace planlight {
namespace {

/// A camera with every parameter in use, turned and off the origin.
CameraModel odd_camera() {
    CameraModel c;
    c.width = 1920, c.height = 1200;
    c.focal_x = 2500.5, c.focal_y = 2481.25;
    c.centre_x = 951.3, c.centre_y = 640.7;
    c.k1 = -0.21, c.k2 = 0.13, c.p1 = 0.0012, c.p2 = -0.0021, c.k3 = -0.03;
    Eigen::Matrix<double, 6, 1> twist;
    twist << 0.3, -0.5, 0.7, 40, -25, 900;
    c.device_from_rig = transform_from_twist(twist);
    return c;
}

std::vector<Eigen::Vector3d> points_before(const CameraModel& camera, int count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> side(-250, 250), depth(700, 1200);
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < count; ++i)
        points.push_back(camera.device_from_rig.inverse() * Eigen::Vector3d(side(random), side(random), depth(random)));
    return points;
}

/// OpenCV's own projection, the third party.
Eigen::Vector2d by_opencv(const CameraModel& c, const Eigen::Vector3d& p) {
    const cv::Matx33d K(c.focal_x, 0, c.centre_x, 0, c.focal_y, c.centre_y, 0, 0, 1);
    const Eigen::Vector3d w = rotation_vector(c.device_from_rig.linear());
    const Eigen::Vector3d t = c.device_from_rig.translation();
    std::vector<cv::Point2d> pixel;
    cv::projectPoints(std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}}, cv::Vec3d(w.x(), w.y(), w.z()),
                      cv::Vec3d(t.x(), t.y(), t.z()), K, cv::Mat_<double>({1, 5}, {c.k1, c.k2, c.p1, c.p2, c.k3}),
                      pixel);
    return {pixel[0].x, pixel[0].y};
}

TEST(CameraModel, ProjectsAsOpenCvDoesToAMillionthOfAPixel) {
    const CameraModel camera = odd_camera();
    for (const auto& p : points_before(camera, 200)) {
        const auto pixel = project(camera, p);
        ASSERT_TRUE(pixel);
        EXPECT_LT((*pixel - by_opencv(camera, p)).norm(), 1e-6);
    }
}

TEST(CameraModel, TheRayThroughAPixelMeetsThePointThatIsSeenThere) {
    const CameraModel camera = odd_camera();
    for (const auto& p : points_before(camera, 200)) {
        const auto ray = ray_through(camera, by_opencv(camera, p));
        ASSERT_TRUE(ray);
        EXPECT_NEAR(ray->direction.norm(), 1, 1e-12);
        EXPECT_LT((p - ray->origin).cross(ray->direction).norm(), 1e-6);  // distance of point and ray, mm
        EXPECT_GT((p - ray->origin).dot(ray->direction), 0);
    }
}

TEST(CameraModel, DerivativeAgreesWithSmallSteps) {
    const CameraModel camera = odd_camera();
    for (const auto& p : points_before(camera, 20)) {
        Eigen::Matrix<double, 2, 3> J;
        ASSERT_TRUE(project(camera, p, J));
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d step = 1e-4 * Eigen::Vector3d::Unit(axis);
            const Eigen::Vector2d slope = (by_opencv(camera, p + step) - by_opencv(camera, p - step)) / 2e-4;
            EXPECT_LT((J.col(axis) - slope).norm(), 1e-5);
        }
    }
}

TEST(CameraModel, APointBehindTheDeviceIsNotSeen) {
    CameraModel camera = odd_camera();
    camera.device_from_rig.setIdentity();
    EXPECT_FALSE(project(camera, {0, 0, -500}));
    EXPECT_FALSE(project(camera, {0, 0, 0}));
}

TEST(CameraModel, WhereTheDistortionTurnsBackNothingIsSeen) {
    CameraModel camera = odd_camera();
    camera.device_from_rig.setIdentity();
    camera.k2 = camera.k3 = 0;  // x (1 - 0.21 r^2) turns back at r = 1.26
    EXPECT_TRUE(project(camera, {500, 0, 1000}));
    EXPECT_FALSE(project(camera, {2000, 0, 1000}));
}

TEST(CameraModel, ThePictureReachesHalfAPixelPastTheOutermostCentres) {
    const CameraModel camera = odd_camera();
    EXPECT_TRUE(in_picture(camera, {-0.5, -0.5}));
    EXPECT_TRUE(in_picture(camera, {1919.4, 1199.4}));
    EXPECT_FALSE(in_picture(camera, {1919.6, 10}));
    EXPECT_FALSE(in_picture(camera, {10, std::nan("")}));
}

}  // namespace
}  // namespace planlight
