#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "planning_io/types/error.h"
#include "segmentation/build_skin_lut.h"
#include "tests/support/analytic_head.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

TriangleMesh sphere(double radius, int splits) {
    TriangleMesh mesh;
    mesh.vertices_in_ct = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int s = 0; s < splits; ++s) {
        std::map<std::pair<int, int>, std::int32_t> middles;
        std::vector<std::array<std::int32_t, 3>> finer;
        const auto middle = [&](std::int32_t a, std::int32_t b) {
            const auto [found, fresh] =
                middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(mesh.vertices_in_ct.size()));
            if (fresh)
                mesh.vertices_in_ct.push_back((mesh.vertices_in_ct[static_cast<std::size_t>(a)] +
                                               mesh.vertices_in_ct[static_cast<std::size_t>(b)])
                                                  .normalized());
            return found->second;
        };
        for (const auto& [a, b, c] : mesh.triangles) {
            const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (const auto& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) finer.push_back(t);
        }
        mesh.triangles = std::move(finer);
    }
    mesh.normals_in_ct = mesh.vertices_in_ct;
    for (auto& p : mesh.vertices_in_ct) p *= radius;
    return mesh;
}

TriangleMesh triangle_soup(int count, double size_mm, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-20, 20), corner(-size_mm, size_mm);
    TriangleMesh mesh;
    for (std::int32_t t = 0; t < count; ++t) {
        const Vector3d centre(place(random), place(random), place(random));
        for (int c = 0; c < 3; ++c)
            mesh.vertices_in_ct.push_back(centre + Vector3d(corner(random), corner(random), corner(random)));
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

struct PlainSkin {
    std::vector<int> x, y, z;
    explicit PlainSkin(const SkinLut& lut) {
        for (const auto& s : lut.skin) {
            x.push_back(s.voxel[0]);
            y.push_back(s.voxel[1]);
            z.push_back(s.voxel[2]);
        }
    }
    int least_squared(int i, int j, int k) const {
        int least = std::numeric_limits<int>::max();
        for (std::size_t s = 0; s < x.size(); ++s)
            least = std::min(least, (x[s] - i) * (x[s] - i) + (y[s] - j) * (y[s] - j) + (z[s] - k) * (z[s] - k));
        return least;
    }
};

int squared_to_pointer(const SkinLut& lut, int i, int j, int k) {
    const std::size_t index =
        (static_cast<std::size_t>(k) * static_cast<std::size_t>(lut.size[1]) + static_cast<std::size_t>(j)) *
            static_cast<std::size_t>(lut.size[0]) +
        static_cast<std::size_t>(i);
    const auto& v = lut.skin.at(lut.nearest.at(index)).voxel;
    return (v[0] - i) * (v[0] - i) + (v[1] - j) * (v[1] - j) + (v[2] - k) * (v[2] - k);
}

TEST(BuildSkinLut, PointsEveryVoxelOfASmallTableToItsNearestSkinVoxel) {
    for (unsigned seed = 1; seed <= 12; ++seed) {
        LutSettings settings;
        settings.voxel_mm = 1 + 0.2 * seed;
        settings.margin_mm = 3.0 * (seed % 4);
        const SkinLut lut = build_skin_lut(triangle_soup(static_cast<int>(seed * seed), 1 + seed % 5, seed), settings);
        const PlainSkin plain(lut);
        std::size_t wrong = 0;
        for (int k = 0; k < lut.size[2]; ++k)
            for (int j = 0; j < lut.size[1]; ++j)
                for (int i = 0; i < lut.size[0]; ++i)
                    wrong += squared_to_pointer(lut, i, j, k) != plain.least_squared(i, j, k);
        EXPECT_EQ(wrong, 0U) << "seed " << seed << ", " << lut.skin.size() << " skin voxels";
    }
}

TEST(BuildSkinLut, PointsRandomVoxelsOfALargeTableToTheirNearestSkinVoxel) {
    const SkinLut lut = build_skin_lut(analytic_head_mesh(3));
    const PlainSkin plain(lut);
    std::mt19937 random(3);
    std::size_t wrong = 0;
    for (int n = 0; n < 10000; ++n) {
        int v[3];
        for (std::size_t a = 0; a < 3; ++a) v[a] = std::uniform_int_distribution<int>(0, lut.size[a] - 1)(random);
        wrong += squared_to_pointer(lut, v[0], v[1], v[2]) != plain.least_squared(v[0], v[1], v[2]);
    }
    EXPECT_EQ(wrong, 0U);
}

TEST(BuildSkinLut, SkinVoxelsAreThoseTheTrianglesPassThrough) {
    const TriangleMesh soup = triangle_soup(60, 6, 5);
    LutSettings settings;
    settings.margin_mm = 4;
    const SkinLut lut = build_skin_lut(soup, settings);
    std::vector<double> closest(lut.skin.size(),
                                1e9);  // how far outside its cube the nearest sample of the surface lies
    std::map<std::array<int, 3>, std::size_t> skin_of;
    for (std::size_t s = 0; s < lut.skin.size(); ++s)
        skin_of[{lut.skin[s].voxel[0], lut.skin[s].voxel[1], lut.skin[s].voxel[2]}] = s;
    std::size_t missed = 0;
    constexpr int kSteps = 150;  // of at most 17/150 mm: samples are within 0.12 mm of any point of the surface
    for (const auto& t : soup.triangles)
        for (int a = 0; a <= kSteps; ++a)
            for (int b = 0; a + b <= kSteps; ++b) {
                const Vector3d p = (a * soup.vertices_in_ct[static_cast<std::size_t>(t[0])] +
                                    b * soup.vertices_in_ct[static_cast<std::size_t>(t[1])] +
                                    (kSteps - a - b) * soup.vertices_in_ct[static_cast<std::size_t>(t[2])]) /
                                   kSteps;
                const Vector3d g = (p - lut.origin_in_ct) / lut.voxel_mm;
                const Eigen::Vector3i v = (g.array() + 0.5).floor().cast<int>();
                missed += !skin_of.contains({v.x(), v.y(), v.z()});
                for (int n = 0; n < 27; ++n) {
                    const Eigen::Vector3i w = v + Eigen::Vector3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
                    const auto found = skin_of.find({w.x(), w.y(), w.z()});
                    if (found == skin_of.end()) continue;
                    const double out = ((g - w.cast<double>()).cwiseAbs().array() - 0.5).maxCoeff();
                    closest[found->second] = std::min(closest[found->second], out);
                }
            }
    EXPECT_EQ(missed, 0U);
    EXPECT_LT(*std::max_element(closest.begin(), closest.end()), 0.12);
    for (const auto& s : lut.skin) {
        const Vector3d centre = lut.origin_in_ct + lut.voxel_mm * Vector3d(s.voxel[0], s.voxel[1], s.voxel[2]);
        EXPECT_LE((s.position_in_ct.cast<double>() - centre).norm(), 0.8661 * lut.voxel_mm);  // half a cube's diagonal
    }
}

TEST(BuildSkinLut, PointersOfASphereCarryItsSkinAndNormals) {
    const double radius = 40;
    const SkinLut lut =
        build_skin_lut(sphere(radius, 6));  // edges up to 1.6 mm: middles of triangles lie e^2/(6 R) = 0.011 mm inside
    for (const auto& s : lut.skin) {
        ASSERT_NEAR(s.position_in_ct.norm(), radius, 0.011);
        ASSERT_GT(s.normal_in_ct.dot(s.position_in_ct.normalized()), 0.9999F);
    }
    // The voxel table's answer is at most one voxel diagonal further than the truth.
    const SkinPoint* s = lut.nearest_skin({60, 30, -20});
    ASSERT_NE(s, nullptr);
    EXPECT_LT((s->position_in_ct.cast<double>() - 40 * Vector3d(60, 30, -20).normalized()).norm(), 1.8);
}

TEST(BuildSkinLut, SignedDistanceOfASphereIsItsAnalyticDistance) {
    const double radius = 40;
    const SkinLut lut = build_skin_lut(sphere(radius, 6));
    std::mt19937 random(9);
    std::normal_distribution<double> direction;
    double worst_near = 0, worst_far = 0, worst_turn = 1;
    for (int n = 0; n < 20000; ++n) {
        const Vector3d d = Vector3d(direction(random), direction(random), direction(random)).normalized();
        const double r = std::uniform_real_distribution<double>(5, 75)(random);
        const auto found = lut.signed_distance(r * d);
        ASSERT_TRUE(found);
        const double error = std::abs(found->mm - (r - radius));
        (std::abs(r - radius) < 3 ? worst_near : worst_far) =
            std::max(std::abs(r - radius) < 3 ? worst_near : worst_far, error);
        if (std::abs(r - radius) < 3) worst_turn = std::min(worst_turn, found->gradient.normalized().dot(d));
    }
    // Trilinear on 2 mm over curvature 1/40 in two directions: 2 h^2/(8 R) = 0.025 mm; chords 0.003 mm.
    EXPECT_LT(worst_near, 0.035);
    EXPECT_GT(worst_turn, 0.998);
    // Far away the pointer's distance: it looks past the nearest point by up to a voxel diagonal e, e^2/(2 d) with d >
    // 5 mm; near the centre the curvature of the distance itself.
    EXPECT_LT(worst_far, 0.5);
}

TEST(BuildSkinLut, SignedDistanceVanishesOnTheAnalyticHead) {
    const TriangleMesh mesh = analytic_head_mesh(2);
    const SkinLut lut = build_skin_lut(mesh);
    std::mt19937 random(4);
    std::vector<double> errors;
    std::size_t turned = 0;
    for (int n = 0; n < 5000; ++n) {
        const std::size_t v = std::uniform_int_distribution<std::size_t>(0, mesh.vertices_in_ct.size() - 1)(random);
        const Vector3d p = on_analytic_head(mesh.vertices_in_ct[v] + Vector3d(0.7, -0.6, 0.5));
        const auto found = lut.signed_distance(p);
        ASSERT_TRUE(found);
        errors.push_back(std::abs(found->mm));
        turned += found->gradient.normalized().dot(analytic_head_normal(p)) < 0.99;
        const auto outside = lut.signed_distance(p + 2 * analytic_head_normal(p)),
                   inside = lut.signed_distance(p - 2 * analytic_head_normal(p));
        ASSERT_GT(outside->mm, 0);
        ASSERT_LT(inside->mm, 0);
    }
    std::sort(errors.begin(), errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.02);  // h^2/(8 R) twice for a radius of 60 mm, and chords of 2 mm
    // Creases where nose and ears leave the head (radius of a few mm) are beyond a field of 2 mm.
    EXPECT_LT(errors[errors.size() * 95 / 100], 0.05);
    EXPECT_LT(turned, errors.size() / 20);
}

TEST(BuildSkinLut, SignIsRightEverywhereAndCornersAreOutside) {
    const SkinLut lut = build_skin_lut(analytic_head_mesh(3));
    std::size_t wrong = 0, n = 0;
    for (int k = 0; k < lut.distance_size[2]; k += 2)
        for (int j = 0; j < lut.distance_size[1]; j += 2)
            for (int i = 0; i < lut.distance_size[0]; ++i) {
                const std::size_t index =
                    (static_cast<std::size_t>(k) * static_cast<std::size_t>(lut.distance_size[1]) +
                     static_cast<std::size_t>(j)) *
                        static_cast<std::size_t>(lut.distance_size[0]) +
                    static_cast<std::size_t>(i);
                const double truth =
                    analytic_head_distance(lut.origin_in_ct + lut.distance_voxel_mm * Vector3d(i, j, k));
                if (std::abs(truth) < 0.3) continue;  // chords of 3 mm edges in creases
                ++n;
                wrong += (truth < 0) != (lut.distance_mm[index] < 0);
            }
    EXPECT_GT(n, 100000U);
    EXPECT_EQ(wrong, 0U);
}

TEST(BuildSkinLut, FlagsOfATriangleReachTheTable) {
    TriangleMesh mesh = sphere(20, 4);
    mesh.flags.assign(mesh.vertices_in_ct.size(), kSkin);
    for (std::size_t v = 0; v < mesh.flags.size(); ++v)
        if (mesh.vertices_in_ct[v].z() < -10) mesh.flags[v] = kCutPlane;
    const SkinLut lut = build_skin_lut(mesh);
    for (const auto& s : lut.skin) {
        if (s.position_in_ct.z() < -10.1F) {
            EXPECT_EQ(s.flags, kCutPlane);
        }
        if (s.position_in_ct.z() > -7) {
            EXPECT_EQ(s.flags, kSkin);
        }  // edges are below 2.5 mm
    }
}

TEST(BuildSkinLut, RefusesWhatCannotBeATable) {
    EXPECT_THROW(build_skin_lut({}), InputError);
    LutSettings fine;
    fine.voxel_mm = 0.1;
    EXPECT_THROW(build_skin_lut(sphere(40, 2), fine), InputError);  // 1600^3 voxels
    LutSettings none;
    none.voxel_mm = 0;
    EXPECT_THROW(build_skin_lut(sphere(40, 2), none), InputError);
    TriangleMesh broken = sphere(40, 2);
    broken.triangles[3][1] = 100000;
    EXPECT_THROW(build_skin_lut(broken), InputError);
    broken = sphere(40, 2);
    broken.vertices_in_ct[5].x() = NAN;
    EXPECT_THROW(build_skin_lut(broken), InputError);
}

}  // namespace
}  // namespace planlight::test
