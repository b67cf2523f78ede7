#include "tests/registration/matching/matching_scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/analytic_head.h"

namespace planlight::test {

using Eigen::Vector3d;

RigidTransform random_pose(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> shift(-150, 150);
    RigidTransform pose = RigidTransform::Identity();
    const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
    pose.linear() = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
    for (int axis = 0; axis < 3; ++axis) pose.translation()[axis] = shift(random);
    return pose;
}

PointCloud moved(const PointCloud& cloud_in_ct, const RigidTransform& rig_from_ct) {
    PointCloud cloud = cloud_in_ct;
    for (Vector3d& p : cloud.points_in_rig) p = rig_from_ct * p;
    for (Vector3d& n : cloud.normals_in_rig) n = rig_from_ct.linear() * n;
    return cloud;
}

PointCloud spoiled(const PointCloud& cloud, double noise_mm, double stray_share, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, noise_mm), any;
    std::uniform_real_distribution<double> unit;
    Vector3d low = cloud.points_in_rig.front(), high = low;
    for (const Vector3d& p : cloud.points_in_rig) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    PointCloud result = cloud;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (unit(random) < stray_share) {
            for (int axis = 0; axis < 3; ++axis)
                result.points_in_rig[i][axis] = low[axis] - 20 + unit(random) * (high[axis] - low[axis] + 40);
            const double x = any(random), y = any(random), z = any(random);
            result.normals_in_rig[i] = Vector3d(x, y, z).normalized();
        } else {
            result.points_in_rig[i] += noise(random) * cloud.normals_in_rig[i];
        }
    }
    return result;
}

PointCloud head_view(View view, double width_mm, int points, unsigned seed) {
    const Vector3d eye = view == View::front   ? Vector3d(120, -850, 150)
                         : view == View::left  ? Vector3d(850, -250, 100)
                         : view == View::right ? Vector3d(-850, -200, 50)
                                               : Vector3d(80, -350, 850);
    return view_of_analytic_head(eye, width_mm, points, seed);
}

const SkinLut& head_lut() {
    static const SkinLut lut = analytic_head_lut();
    return lut;
}

double target_error_mm(const RigidTransform& ct_from_rig, const RigidTransform& truth, const PointCloud& cloud_in_rig) {
    Vector3d middle = Vector3d::Zero(), outwards = Vector3d::Zero();
    for (const Vector3d& p : cloud_in_rig.points_in_rig) middle += p / static_cast<double>(cloud_in_rig.size());
    for (const Vector3d& n : cloud_in_rig.normals_in_rig) outwards += n;
    const Vector3d target = middle - 60 * outwards.normalized();
    double worst = 0;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-40.0, 40.0}) {
            const Vector3d p = target + side * Vector3d::Unit(axis);
            worst = std::max(worst, (ct_from_rig * p - truth * p).norm());
        }
    return worst;
}

PointCloud sphere_view(double radius_mm, int points, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> any;
    PointCloud cloud;
    while (static_cast<int>(cloud.size()) < points) {
        const double x = any(random), y = any(random), z = any(random);
        const Vector3d n = Vector3d(x, y, z).normalized();
        if (n.y() > -0.3) continue;
        cloud.points_in_rig.push_back(radius_mm * n);
        cloud.normals_in_rig.push_back(n);
    }
    return cloud;
}

PointCloud cylinder_view(double radius_mm, double height_mm, int points, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> angle(-1.25, 1.25), height(-height_mm / 2, height_mm / 2);
    PointCloud cloud;
    for (int i = 0; i < points; ++i) {
        const double a = angle(random);
        const Vector3d n(std::sin(a), -std::cos(a), 0);
        cloud.points_in_rig.push_back(radius_mm * n + height(random) * Vector3d::UnitZ());
        cloud.normals_in_rig.push_back(n);
    }
    return cloud;
}

PointCloud plane_view(double width_mm, int points, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> across(-width_mm / 2, width_mm / 2);
    PointCloud cloud;
    for (int i = 0; i < points; ++i) {
        const double x = across(random), z = across(random);
        cloud.points_in_rig.push_back({x, 0, z});
        cloud.normals_in_rig.push_back(-Vector3d::UnitY());
    }
    return cloud;
}

}  // namespace planlight::test
