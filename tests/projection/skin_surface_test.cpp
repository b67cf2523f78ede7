#include "projection/skin_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "planning_io/types/error.h"
#include "projection/skin_paths.h"
#include "tests/projection/shapes.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
constexpr double kRadius_mm = 80;

// Triangles of 3.2 mm sag 0.022 mm below a ball of 80 mm: no answer on the mesh can be nearer to the ball than that.
constexpr double kSag_mm = 0.025;

TEST(SkinSurface, HitsTheNearSideOfABallFirst) {
    const SkinSurface skin(test::ball_mesh(kRadius_mm, 5));
    const auto hit = skin.first_hit({{10, 20, 300}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->p_in_ct.z(), std::sqrt(80.0 * 80 - 500), 2 * kSag_mm);
    EXPECT_NEAR(hit->normal_in_ct.dot(hit->p_in_ct.normalized()), 1, 1e-5);
    EXPECT_FALSE(skin.first_hit({{10, 20, 300}, {0, 0, 1}}));
}

/// Normals of single vertices that are 10 degrees and more wrong, as steep edges between long voxels leave them, do not
/// turn the perpendicular.
TEST(SkinSurface, ItsPerpendicularIsThatOfWhatLiesRound) {
    TriangleMesh mesh = test::ball_mesh(kRadius_mm, 5);
    std::mt19937 random(5);
    std::normal_distribution<double> wrong(0, 0.2);
    mesh.normals_in_ct.resize(mesh.vertices_in_ct.size());
    for (std::size_t v = 0; v < mesh.vertices_in_ct.size(); ++v)
        mesh.normals_in_ct[v] =
            (mesh.vertices_in_ct[v].normalized() + Vector3d(wrong(random), wrong(random), wrong(random))).normalized();
    const SkinSurface skin(mesh);
    double single = 0;
    for (const Vector3d& way : {Vector3d(1, 2, 3), Vector3d(-3, 1, 0.5), Vector3d(0.2, -1, -2)}) {
        const auto at = skin.nearest(kRadius_mm * way.normalized());
        single = std::max(single, std::acos(at.normal_in_ct.dot(way.normalized())));
        EXPECT_LT(std::acos(std::min(1.0, skin.mean_normal(at, 8).dot(way.normalized()))), 0.02) << way.transpose();
    }
    EXPECT_GT(single, 0.1) << "the mesh's own are as wrong as they were made";
}

TEST(SkinSurface, TellsInsideFromOutside) {
    const SkinSurface skin(test::ball_mesh(kRadius_mm, 4));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-100, 100);
    for (int i = 0; i < 300; ++i) {
        const Vector3d p(place(random), place(random), place(random));
        if (std::abs(p.norm() - kRadius_mm) < 0.2) continue;
        EXPECT_EQ(skin.inside(p), p.norm() < kRadius_mm) << p.transpose();
    }
}

TEST(SkinSurface, AStraightWayOnABallIsAGreatCircle) {
    const SkinSurface skin(test::ball_mesh(kRadius_mm, 5));
    std::mt19937 random(5);
    std::normal_distribution<double> any;
    for (int i = 0; i < 50; ++i) {
        const auto start = skin.nearest(kRadius_mm * Vector3d(any(random), any(random), any(random)).normalized());
        const Vector3d n = start.p_in_ct.normalized();
        const Vector3d t = n.cross(Vector3d(any(random), any(random), any(random))).normalized();
        const double way_mm = 60;
        const auto end = skin.walk(start, way_mm * t);
        ASSERT_TRUE(end);
        const double angle = way_mm / kRadius_mm;
        const Vector3d truth = kRadius_mm * (std::cos(angle) * n + std::sin(angle) * t);
        // Asked for: 0.1 mm in length, 1 degree in direction (1 mm here); the mesh's facets allow 0.2 degrees.
        EXPECT_NEAR(kRadius_mm * std::acos(end->p_in_ct.normalized().dot(n)), way_mm, 0.05) << i;
        EXPECT_LT((end->p_in_ct - truth).norm(), way_mm * 0.2 * std::numbers::pi / 180) << i;
    }
}

TEST(SkinSurface, AStraightWayOnATubeIsAHelix) {
    const SkinSurface skin(test::tube_mesh(40, 200, 2));
    const auto start = skin.nearest({40, 0, -50});
    for (const double slant : {0.0, 0.3, 0.8, 1.2}) {
        const double way_mm = 70;
        const auto end = skin.walk(start, way_mm * Vector3d(0, std::cos(slant), std::sin(slant)));
        ASSERT_TRUE(end);
        const double angle = way_mm * std::cos(slant) / 40;
        const Vector3d truth(40 * std::cos(angle), 40 * std::sin(angle), -50 + way_mm * std::sin(slant));
        EXPECT_LT((end->p_in_ct - truth).norm(), 0.1) << slant;
    }
}

TEST(SkinSurface, WalksExactlyOnAFlatSheetAndNotBeyondItsEdge) {
    const SkinSurface skin(test::sheet_mesh(100, 3));
    const auto start = skin.nearest({-20, 5, 7});
    const auto end = skin.walk(start, {41.7, -23.1, 0});
    ASSERT_TRUE(end);
    EXPECT_LT((end->p_in_ct - Vector3d(21.7, -18.1, 0)).norm(), 1e-9);
    EXPECT_FALSE(skin.walk(start, {200, 0, 0}));
}

TEST(SkinSurface, WalksThroughAVertexAndAlongAnEdge) {
    const SkinSurface skin(test::sheet_mesh(90, 3));
    const auto start = skin.nearest({-30, -30, 0});  // a vertex; the rows of edges run along x
    for (const Vector3d& way : {Vector3d(30, 30, 0), Vector3d(30, 0, 0), Vector3d(0, 30, 0)}) {
        const auto end = skin.walk(start, way);
        ASSERT_TRUE(end) << way.transpose();
        EXPECT_LT((end->p_in_ct - start.p_in_ct - way).norm(), 1e-6);
    }
}

TEST(StraightWay, JoinsTwoPointsOfABallByTheGreatCircle) {
    const SkinSurface skin(test::ball_mesh(kRadius_mm, 5));
    std::mt19937 random(7);
    std::normal_distribution<double> any;
    for (int i = 0; i < 30; ++i) {
        const Vector3d a = Vector3d(any(random), any(random), any(random)).normalized();
        const Vector3d b = (a + 0.8 * Vector3d(any(random), any(random), any(random)).normalized()).normalized();
        const auto line = straight_way(skin, skin.nearest(kRadius_mm * a), skin.nearest(kRadius_mm * b), 0.5);
        const double truth_mm = kRadius_mm * std::acos(a.dot(b));
        EXPECT_NEAR(length_mm(line), truth_mm, 0.001 * truth_mm + 0.02);
        const Vector3d pole = a.cross(b).normalized();
        for (const auto& p : line.points) EXPECT_LT(std::abs(p.p_in_ct.dot(pole)), 0.12);
        EXPECT_LT((line.points.back().p_in_ct - kRadius_mm * b).norm(), 2 * kSag_mm);
    }
}

TEST(SkinSurface, RefusesAMeshThatNamesMissingVertices) {
    TriangleMesh mesh = test::sheet_mesh(10, 5);
    mesh.triangles[0][1] = 1000;
    EXPECT_THROW(SkinSurface{mesh}, InputError);
    EXPECT_THROW(SkinSurface{TriangleMesh{}}, InputError);
    mesh = test::sheet_mesh(10, 5);
    mesh.vertices_in_ct[0].x() = std::nan("");
    EXPECT_THROW(SkinSurface{mesh}, InputError);
}

}  // namespace
}  // namespace planlight
