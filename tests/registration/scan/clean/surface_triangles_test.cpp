#include "registration/scan/clean/surface_triangles.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace planlight {
namespace {

constexpr double kDistance = 900, kRadius = 80, kFocal_px = 2000;

/// Where a ray from the origin through a pixel meets a ball before it; not finite where it misses.
Eigen::Vector3d on_ball(double u, double v) {
    const Eigen::Vector3d direction = Eigen::Vector3d(u / kFocal_px, v / kFocal_px, 1).normalized(),
                          centre(0, 0, kDistance);
    const double along = direction.dot(centre), under = along * along - kDistance * kDistance + kRadius * kRadius;
    if (under < 0) return Eigen::Vector3d::Constant(std::nan(""));
    return (along - std::sqrt(under)) * direction;
}

/// Light from the origin on a ball, a pixel grid of `step`; points steeper than 75 degrees left out.
PointCloud ball(double step) {
    PointCloud cloud;
    for (double v = -200; v <= 200; v += step)
        for (double u = -200; u <= 200; u += step) {
            const Eigen::Vector3d p = on_ball(u, v);
            if (!p.allFinite()) continue;
            const Eigen::Vector3d normal = (p - Eigen::Vector3d(0, 0, kDistance)) / kRadius;
            if (-normal.dot(p.normalized()) < std::cos(75 * std::numbers::pi / 180)) continue;
            cloud.points_in_rig.push_back(p);
            cloud.normals_in_rig.push_back(normal);
            cloud.pixels_in_projector.emplace_back(u, v);
        }
    return cloud;
}

/// Two planes that face the light, the left half 20 mm nearer.
PointCloud step_of_20_mm() {
    PointCloud cloud;
    for (double v = -100; v <= 100; v += 4)
        for (double u = -100; u <= 100; u += 4) {
            cloud.points_in_rig.push_back((u < 0 ? 880 : 900) * Eigen::Vector3d(u / kFocal_px, v / kFocal_px, 1));
            cloud.normals_in_rig.emplace_back(0, 0, -1);
            cloud.pixels_in_projector.emplace_back(u, v);
        }
    return cloud;
}

Eigen::Vector3d twice_area(const PointCloud& cloud, const std::array<std::int32_t, 3>& t) {
    const auto at = [&](std::size_t corner) { return cloud.points_in_rig[static_cast<std::size_t>(t[corner])]; };
    return (at(1) - at(0)).cross(at(2) - at(0));
}

TEST(SurfaceTriangles, ABallHasItsAreaAndLooksOutwards) {
    const PointCloud cloud = ball(4);
    const auto triangles = surface_triangles(cloud);
    // The cap that the light meets at up to 75 degrees reaches to the angle a from the ball's middle.
    const double edge = std::asin(kRadius * std::sin(75 * std::numbers::pi / 180) / kDistance);  // seen from the origin
    const double a = 75 * std::numbers::pi / 180 - edge;
    const double cap = 2 * std::numbers::pi * kRadius * kRadius * (1 - std::cos(a));
    double area = 0;
    for (const auto& t : triangles) {
        const Eigen::Vector3d normal = twice_area(cloud, t);
        area += normal.norm() / 2;
        ASSERT_GT(normal.dot(cloud.normals_in_rig[static_cast<std::size_t>(t[0])]), 0);
    }
    EXPECT_NEAR(area / cap, 1, 0.05);  // the rim is ragged by half a pixel step
}

TEST(SurfaceTriangles, ASmoothSurfaceHasNoHolesAndNoEdgeOfThreeTriangles) {
    const PointCloud cloud = ball(4);
    std::map<std::set<std::int32_t>, int> used;
    const auto triangles = surface_triangles(cloud);
    for (const auto& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) ++used[{t[i], t[(i + 1) % 3]}];
    int once = 0;
    for (const auto& [edge, count] : used) {
        ASSERT_LE(count, 2);
        once += count == 1;
    }
    // Points - edges + triangles of a disc is 1: one rim and no hole.
    EXPECT_EQ(static_cast<long>(cloud.size()) - static_cast<long>(used.size()) + static_cast<long>(triangles.size()),
              1);
    EXPECT_LT(once, 400);
}

TEST(SurfaceTriangles, NoTriangleBridgesAStep) {
    const PointCloud cloud = step_of_20_mm();
    const auto triangles = surface_triangles(cloud);
    EXPECT_EQ(triangles.size(), 2u * 50 * (24 + 25));  // 51 rows; 25 columns to the left, 26 to the right
    for (const auto& t : triangles) {
        const auto nearer = [&](std::size_t corner) {
            return cloud.points_in_rig[static_cast<std::size_t>(t[corner])].z() < 890;
        };
        EXPECT_EQ(nearer(0), nearer(1));
        EXPECT_EQ(nearer(0), nearer(2));
    }
}

TEST(SurfaceTriangles, AnothersCloudIsJoinedAcrossItsNormals) {
    PointCloud cloud = ball(4);
    cloud.pixels_in_projector.clear();
    const auto triangles = surface_triangles(cloud);
    EXPECT_GT(triangles.size(), cloud.size());
    for (const auto& t : triangles)
        ASSERT_GT(twice_area(cloud, t).dot(cloud.normals_in_rig[static_cast<std::size_t>(t[0])]), 0);
}

TEST(SurfaceTriangles, NothingToJoinIsNoSurface) {
    EXPECT_TRUE(surface_triangles({}).empty());
    PointCloud two = ball(4);
    two.normals_in_rig.clear();
    two.pixels_in_projector.clear();
    EXPECT_TRUE(surface_triangles(two).empty());  // neither pixels nor normals
    PointCloud broken = ball(20);
    broken.points_in_rig[0].x() = std::nan("");
    for (const auto& t : surface_triangles(broken)) EXPECT_TRUE(t[0] != 0 && t[1] != 0 && t[2] != 0);
}

}  // namespace
}  // namespace planlight
