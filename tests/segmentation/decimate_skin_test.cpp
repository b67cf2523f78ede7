#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "segmentation/closest_point_on_triangle.h"
#include "segmentation/collapse_bound.h"
#include "segmentation/decimate_skin.h"
#include "segmentation/segment_skin.h"
#include "tests/segmentation/distance_to_mesh.h"
#include "tests/segmentation/mesh_facts.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<Vector3d, 3>;

constexpr double kBound_mm = 0.15, kTolerance_mm = 0.01;

/// The greatest distance of any point of `from` to `to`, over-estimated by kTolerance_mm at most: a distance changes by
/// no more than its point moves, so a triangle holds none above that of its middle plus its radius; larger ones are
/// split.
double furthest(const TriangleMesh& from, const TriangleMesh& to) {
    DistanceToMesh distance(to);
    double least = 0;  // of what the answer can be
    std::vector<Triangle> left;
    for (const auto& t : from.triangles) {
        left.push_back({from.vertices_in_ct[static_cast<std::size_t>(t[0])],
                        from.vertices_in_ct[static_cast<std::size_t>(t[1])],
                        from.vertices_in_ct[static_cast<std::size_t>(t[2])]});
        while (!left.empty()) {
            const auto [a, b, c] = left.back();
            left.pop_back();
            const Vector3d middle = (a + b + c) / 3;
            const double d = distance(middle),
                         radius = std::sqrt(std::max(
                             {(a - middle).squaredNorm(), (b - middle).squaredNorm(), (c - middle).squaredNorm()}));
            least = std::max(least, d);
            if (d + radius <= least + kTolerance_mm) continue;
            const Vector3d ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
            for (const Triangle& part : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
                left.push_back(part);
        }
    }
    return least + kTolerance_mm;
}

/// A closed surface r(direction) over a grid of latitudes and longitudes turned about, with edges of about `edge_mm`.
template <class Radius>
TriangleMesh star(Radius&& radius_mm, double about_mm, double edge_mm) {
    const int rings = static_cast<int>(std::numbers::pi * about_mm / edge_mm), around = 2 * rings;
    TriangleMesh mesh;
    const auto put = [&](double polar, double turn) {
        const Vector3d way(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
        mesh.vertices_in_ct.push_back(radius_mm(way) * way);
    };
    put(0, 0);
    for (int r = 1; r < rings; ++r)
        for (int a = 0; a < around; ++a)
            put(std::numbers::pi * r / rings, std::numbers::pi * 2 * (a + 0.5 * (r % 2)) / around);
    put(std::numbers::pi, 0);
    const auto at = [&](int r, int a) { return 1 + (r - 1) * around + (a + around) % around; };
    const int last = static_cast<int>(mesh.vertices_in_ct.size()) - 1;
    for (int a = 0; a < around; ++a) {
        mesh.triangles.push_back({0, at(1, a), at(1, a + 1)});
        mesh.triangles.push_back({last, at(rings - 1, a + 1), at(rings - 1, a)});
        for (int r = 1; r + 1 < rings; ++r) {
            const int shift = r % 2;  // odd rows stand half a step on
            mesh.triangles.push_back({at(r, a), at(r + 1, a + shift), at(r, a + 1)});
            mesh.triangles.push_back({at(r + 1, a + shift - 1), at(r + 1, a + shift), at(r, a)});
        }
    }
    mesh.normals_in_ct.assign(mesh.vertices_in_ct.size(), Vector3d::UnitZ());
    return mesh;
}

struct Shape {
    const char* name;
    TriangleMesh mesh;
};

std::vector<Shape> shapes() {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 0.04);
    std::vector<Shape> all;
    all.push_back({"ball", star([](const Vector3d&) { return 9.0; }, 9, 0.7)});
    all.push_back({"bumps", star(
                                [](const Vector3d& w) {
                                    return 9 + std::sin(9 * w.x()) * std::sin(8 * w.y()) + 0.5 * std::cos(11 * w.z());
                                },
                                9, 0.5)});
    all.push_back({"scanner's noise", star([&](const Vector3d&) { return 9 + noise(random); }, 9, 0.7)});
    all.push_back({"disc with a sharp rim", star(
                                                [](const Vector3d& w) {
                                                    return 1 / std::sqrt(w.x() * w.x() / 100 + w.y() * w.y() / 80 +
                                                                         w.z() * w.z() / 3);
                                                },
                                                8, 0.5)});
    return all;
}

TEST(DecimateSkin, NoPointOfEitherSurfaceIsFurtherThanTheBoundFromTheOther) {
    for (const Shape& shape : shapes()) {
        ASSERT_EQ(facts_of(shape.mesh).bad_edges, 0U) << shape.name;
        const TriangleMesh few = decimate_skin(shape.mesh, 4, kBound_mm);
        const double lost = furthest(shape.mesh, few), invented = furthest(few, shape.mesh);
        RecordProperty(std::string("um_") + shape.name, static_cast<int>(1000 * std::max(lost, invented)));
        EXPECT_LE(lost, kBound_mm + kTolerance_mm) << shape.name;
        EXPECT_LE(invented, kBound_mm + kTolerance_mm) << shape.name;
        EXPECT_GT(std::max(lost, invented), 0.3 * kBound_mm) << shape.name;  // the bound is used, not only kept
        EXPECT_LT(few.triangles.size(), shape.mesh.triangles.size() / 2) << shape.name;
        const MeshFacts facts = facts_of(few);
        EXPECT_EQ(facts.bad_edges, 0U) << shape.name;
        EXPECT_EQ(facts.pieces, 1U) << shape.name;
        EXPECT_EQ(facts.euler, 2) << shape.name;
    }
}

/// The nearest point of the fan from `centre` over the ring, by trying its triangles.
double distance_to_fan(const Vector3d& p, const Vector3d& centre, const std::vector<Vector3d>& ring) {
    double least = 1e9;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector3d &a = ring[i], &b = ring[(i + 1) % ring.size()];
        const Vector3d w = closest_weights(p, centre, a, b);
        least = std::min(least, (w.x() * centre + w.y() * a + w.z() * b - p).norm());
    }
    return least;
}

TEST(DecimateSkin, ACollapseMovesTheSurfaceByNoMoreThanItsBound) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(0, 1);
    int proven = 0;
    double tightest = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        const int n = 3 + trial % 6;
        std::vector<Vector3d> ring;
        for (int i = 0; i < n; ++i) {
            const double turn = 2 * std::numbers::pi * (i + 0.7 * any(random)) / n, radius = 0.4 + any(random);
            ring.emplace_back(radius * std::cos(turn), radius * std::sin(turn), 0.6 * any(random));
        }
        const Vector3d v(0.2 * any(random), 0.2 * any(random), 0.6 * any(random));
        const std::size_t target = static_cast<std::size_t>(trial / 6 % n);
        const auto bound = collapse_bound(v, ring, target);
        if (!bound) continue;
        ++proven;
        double most = 0;
        for (int s = 0; s < 200; ++s) {
            const std::size_t i = static_cast<std::size_t>(s % n);
            const double a = any(random), b = any(random) * (1 - a);
            const auto on = [&](const Vector3d& centre) {
                return Vector3d(centre + a * (ring[i] - centre) + b * (ring[(i + 1) % ring.size()] - centre));
            };
            most = std::max(
                {most, distance_to_fan(on(v), ring[target], ring), distance_to_fan(on(ring[target]), v, ring)});
        }
        ASSERT_LE(most, *bound + 1e-12) << "trial " << trial;
        tightest = std::max(tightest, most / *bound);
    }
    EXPECT_GT(proven, 500);
    EXPECT_GT(tightest, 0.9);
}

TEST(DecimateSkin, AHexagonWithARaisedMiddleFallsByItsHeight) {
    std::vector<Vector3d> ring;
    for (int i = 0; i < 6; ++i)
        ring.emplace_back(std::cos(i * std::numbers::pi / 3), std::sin(i * std::numbers::pi / 3), 0);
    const auto bound = collapse_bound({0.05, 0.02, 0.3}, ring, 2);
    ASSERT_TRUE(bound);
    EXPECT_NEAR(*bound, 0.3, 1e-3);  // seen along the mean normal, a little off the plane's
    std::reverse(ring.begin(), ring.end());
    EXPECT_TRUE(collapse_bound({0.05, 0.02, -0.3}, ring, 2));  // the same from below
    ring[1] = {-2, -1.9, 0};
    ring[2] = {-2.1, -2, 0};  // an arm that the target does not see into
    EXPECT_FALSE(collapse_bound({0.05, 0.02, 0.3}, ring, 5));
}

/// A CT of a ball of 40 HU in air, seen through a blur of 0.8 mm.
Volume ball_scan(double radius_mm, double spacing_mm) {
    Volume volume;
    volume.modality = "CT";
    volume.is_hu = true;
    const int n = static_cast<int>(2 * (radius_mm + 8) / spacing_mm);
    volume.size = {n, n, n};
    volume.ct_from_voxel.linear() *= spacing_mm;
    volume.ct_from_voxel.translation().setConstant(-0.5 * spacing_mm * (n - 1) + 0.17);
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const double d = (volume.ct_from_voxel * Vector3d(i, j, k)).norm() - radius_mm;
                volume.values.push_back(
                    static_cast<float>(-1000 + 1040 * 0.5 * std::erfc(d / 0.8 / std::numbers::sqrt2)));
            }
    return volume;
}

TEST(TriangulateSkin, DoesNotShrinkABall) {
    const double radius_mm = 45;
    const Volume volume = ball_scan(radius_mm, 1.1);
    SkinSettings settings;
    settings.threshold = -480;  // half way: the crossing is the ball's own surface
    const TriangleMesh skin = triangulate_skin(volume, segment_skin(volume, settings), settings);
    double sum = 0, worst = 0;
    for (const auto& p : skin.vertices_in_ct) {
        sum += p.norm();
        worst = std::max(worst, std::abs(p.norm() - radius_mm));
    }
    // Where a line of voxels crosses a profile of 0.8 mm blur between centres 1.1 mm apart, its straight chord is off
    // by a few hundredths; to both sides alike.
    EXPECT_NEAR(sum / static_cast<double>(skin.vertices_in_ct.size()), radius_mm, 0.01);
    EXPECT_LT(worst, 0.1);
    // Triangles are chords: of edges up to 2 mm, their middles lie e^2 / (6 R) = 0.015 mm inside, 0.1 % of the volume.
    const double ball_ml = 4.0 / 3 * std::numbers::pi * std::pow(radius_mm, 3) / 1000;
    EXPECT_LT(facts_of(skin).volume_ml, ball_ml);
    EXPECT_GT(facts_of(skin).volume_ml, ball_ml * (1 - 0.0025));
}

}  // namespace
}  // namespace planlight::test
