#include "registration/matching/cloud_pieces.h"

#include <gtest/gtest.h>

#include <random>

#include "registration/matching/cloud_region.h"
#include "registration/matching/surface_sites.h"
#include "tests/registration/matching/matching_scenes.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

/// A square of `width_mm` at `middle`, spanned by two unit vectors; the normal is their cross product.
void add_square(PointCloud& cloud, const Vector3d& middle, const Vector3d& a, const Vector3d& b, double width_mm) {
    for (double u = -width_mm / 2; u <= width_mm / 2; u += 1.5)
        for (double v = -width_mm / 2; v <= width_mm / 2; v += 1.5) {
            cloud.points_in_rig.emplace_back(middle + u * a + v * b);
            cloud.normals_in_rig.emplace_back(a.cross(b));
        }
}

std::size_t large_pieces(const CloudPieces& pieces) {
    std::size_t count = 0;
    for (const int cells : pieces.piece_cells) count += cells >= 50;
    return count;
}

TEST(CloudPieces, AStepInDepthCutsAndASmoothBallDoesNot) {
    PointCloud cloud = sphere_view(80, 12000, 1);
    EXPECT_EQ(large_pieces(cloud_pieces(cloud)), 1u);
    for (const Vector3d& p : plane_view(300, 12000, 2).points_in_rig) {
        if (std::hypot(p.x(), p.z()) < 85) continue;
        cloud.points_in_rig.emplace_back(p.x(), 20, p.z());  // 100 mm behind the front of the ball
        cloud.normals_in_rig.emplace_back(-Vector3d::UnitY());
    }
    EXPECT_EQ(large_pieces(cloud_pieces(cloud)), 2u);
}

TEST(CloudPieces, AHollowCreaseCutsAndARidgeDoesNot) {
    const double h = std::sqrt(0.5);
    PointCloud hollow, ridge;  // two squares that meet at a right angle along x = z = 0, seen from +z
    add_square(hollow, {-30 * h, 0, 30 * h}, Vector3d(h, 0, -h), Vector3d::UnitY(), 60);
    add_square(hollow, {30 * h, 0, 30 * h}, Vector3d(h, 0, h), Vector3d::UnitY(), 60);
    add_square(ridge, {-30 * h, 0, -30 * h}, Vector3d(h, 0, h), Vector3d::UnitY(), 60);
    add_square(ridge, {30 * h, 0, -30 * h}, Vector3d(h, 0, -h), Vector3d::UnitY(), 60);
    EXPECT_EQ(large_pieces(cloud_pieces(hollow)), 2u);
    EXPECT_EQ(large_pieces(cloud_pieces(ridge)), 1u);
}

TEST(CloudPieces, StraysBelongToNoPiece) {
    const PointCloud ball = sphere_view(80, 12000, 1);
    const CloudPieces pieces = cloud_pieces(spoiled(ball, 0.3, 0.25, 3));
    // A stray that falls within a few millimetres of the ball cannot be told: under a tenth of them.
    EXPECT_NEAR(static_cast<double>(pieces.stray_points) / static_cast<double>(pieces.finite_points), 0.25, 0.03);
}

// What a scanner did not measure is at or about its origin: such a heap made strays of the whole scan.
TEST(CloudPieces, AHeapOfPointsAtOnePlaceMakesNoStraysOfTheScan) {
    PointCloud cloud = sphere_view(80, 12000, 1);
    const std::size_t ball = cloud.size();
    for (int i = 0; i < 20000; ++i) {
        cloud.points_in_rig.emplace_back(0.01 * (i % 7), 300 + 0.01 * (i % 11), 0.01 * (i % 13));
        cloud.normals_in_rig.emplace_back(-Vector3d::UnitY());
    }
    const CloudPieces pieces = cloud_pieces(cloud);
    std::size_t strays = 0;
    for (std::size_t i = 0; i < ball; ++i) {
        const int cell = pieces.cell_of_point[i];
        strays += cell < 0 || pieces.cells[static_cast<std::size_t>(cell)].stray;
    }
    EXPECT_LT(strays, ball / 20);
    EXPECT_GT(static_cast<double>(sites_of_cloud(cloud).size()),
              0.9 * static_cast<double>(sites_of_cloud(sphere_view(80, 12000, 1)).size()));
}

TEST(WithinOutline, KeepsWhatTheCameraSeesInARectangleOrALasso) {
    CameraModel camera;
    camera.width = 800;
    camera.height = 600;
    camera.focal_x = camera.focal_y = 1000;
    camera.centre_x = 400;
    camera.centre_y = 300;
    PointCloud cloud;  // at 1 m a pixel is a millimetre
    for (int x = -100; x <= 100; x += 2)
        for (int y = -100; y <= 100; y += 2) {
            cloud.points_in_rig.emplace_back(x, y, 1000);
            cloud.sigma_mm.push_back(static_cast<float>(x));
        }
    cloud.points_in_rig.emplace_back(0, 0, -1000);  // behind it
    cloud.sigma_mm.push_back(0);
    const PointCloud upright = within_outline(cloud, camera, {{450.5, 349.5}, {380.5, 289.5}});
    EXPECT_EQ(upright.size(), 35u * 30u);
    EXPECT_EQ(upright.sigma_mm.size(), upright.size());
    for (const Vector3d& p : upright.points_in_rig) {
        EXPECT_TRUE(p.x() > -19.5 && p.x() < 50.5 && p.y() > -10.5 && p.y() < 49.5);
    }
    const PointCloud half = within_outline(cloud, camera, {{299.5, 199.5}, {500.5, 199.5}, {299.5, 400.5}});
    EXPECT_NEAR(static_cast<double>(half.size()), 101 * 101 / 2.0, 101);
    EXPECT_TRUE(within_outline(cloud, camera, {}).empty());
}

}  // namespace
}  // namespace planlight::test
