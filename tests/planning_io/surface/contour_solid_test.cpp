#include "planning_io/surface/contour_solid.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using Loops = std::vector<std::vector<Vector3d>>;

std::vector<Vector3d> circle(const Vector3d& middle, double radius_mm, bool clockwise = false) {
    std::vector<Vector3d> loop;
    for (int i = 0; i < 72; ++i) {
        const double turn = (clockwise ? -1 : 1) * 2 * M_PI * i / 72;
        loop.push_back(middle + radius_mm * Vector3d(std::cos(turn), std::sin(turn), 0));
    }
    return loop;
}

TriangleMesh solid_of(const Loops& loops, std::vector<std::string>* notes = nullptr) {
    std::vector<std::string> said;
    TriangleMesh solid = contour_solid(loops, "Artery", "set.dcm", said);
    std::map<std::pair<int, int>, int> edges;
    for (const auto& t : solid.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = t[k], b = t[(k + 1) % 3];
            edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
    for (const auto& [edge, sum] : edges) EXPECT_EQ(sum, 0) << "the solid is closed";
    if (notes) *notes = said;
    return solid;
}

/// How often a straight way from far off along `way` enters or leaves the solid before `p`: odd within it.
bool is_within(const TriangleMesh& solid, const Vector3d& p) {
    const Vector3d way = Vector3d(0.3127, 0.8911, 0.0713).normalized();
    int crossings = 0;
    for (const auto& t : solid.triangles) {
        const Vector3d& a = solid.vertices_in_ct[static_cast<std::size_t>(t[0])];
        const Vector3d u = solid.vertices_in_ct[static_cast<std::size_t>(t[1])] - a,
                       v = solid.vertices_in_ct[static_cast<std::size_t>(t[2])] - a, n = u.cross(v);
        const double along = n.dot(a - p) / n.dot(way);
        if (!(along > 0)) continue;
        const Vector3d at = p + along * way - a;
        const double s = at.cross(v).dot(n) / n.squaredNorm(), r = u.cross(at).dot(n) / n.squaredNorm();
        crossings += s >= 0 && r >= 0 && s + r <= 1;
    }
    return crossings % 2 == 1;
}

TEST(ContourSolid, IsNeverSmallerThanItsOutlinesAndHardlyLarger) {
    for (const double radius_mm : {0.3, 0.6, 3.0, 12.0}) {
        Loops loops;
        for (int z = -10; z <= 10; ++z) loops.push_back(circle({10.1, -20.3, 1.0 * z}, radius_mm));
        double least = INFINITY, most = -INFINITY;
        for (const Vector3d& p : solid_of(loops).vertices_in_ct) {
            if (std::abs(p.z()) > 8) continue;
            const double off = std::hypot(p.x() - 10.1, p.y() + 20.3) - radius_mm;
            least = std::min(least, off), most = std::max(most, off);
        }
        EXPECT_GT(least, -0.05) << radius_mm;
        EXPECT_LT(most, radius_mm < 0.4 ? 0.55 : 0.35) << radius_mm << ": drawn three voxels wide at least";
    }
}

/// Voxels as fine as a nerve needs would be hundreds of millions for the box of both.
TEST(ContourSolid, AThinPartIsThereHoweverFarTheOtherPartsAre) {
    Loops loops;
    for (int z = 0; z <= 150; ++z) {
        loops.push_back(circle({0.05 * z, 0.03 * z, 1.0 * z}, 0.5));
        loops.push_back(circle({150, 180, 1.0 * z}, 4));
    }
    const TriangleMesh apart = solid_of(loops);
    for (int z = 0; z <= 150; ++z) {
        EXPECT_TRUE(is_within(apart, {0.05 * z, 0.03 * z, z + 0.2})) << z;
        EXPECT_TRUE(is_within(apart, {150, 180, z + 0.2})) << z;
        EXPECT_FALSE(is_within(apart, {75, 90, z + 0.2})) << z;
    }
    loops.push_back(circle({75, 90, 0}, 125));  // one part now, and its voxels larger than the nerve is
    const TriangleMesh joined = solid_of(loops);
    for (int z = 3; z <= 150; ++z) EXPECT_TRUE(is_within(joined, {0.05 * z, 0.03 * z, z + 0.2})) << z;
}

TEST(ContourSolid, UnevenSlicesAndOneThatLacksAContourLeaveNoHole) {
    Loops uneven;
    for (const double z : {0.0, 1.0, 5.0, 10.0, 15.0, 20.0, 21.0, 26.0}) uneven.push_back(circle({0, 0, z}, 3));
    std::vector<std::string> notes;
    const TriangleMesh solid = solid_of(uneven, &notes);
    for (double z = -2; z < 28; z += 0.7) EXPECT_TRUE(is_within(solid, {0.1, 0.2, z})) << z;
    EXPECT_TRUE(notes.empty());
    Loops lacking;
    for (int z = 0; z <= 30; ++z) {
        if (z != 14 && z != 15) lacking.push_back(circle({0, 0, 1.0 * z}, 3));
        lacking.push_back(circle({30, 0, 1.0 * z}, 3));  // another part has all its slices
    }
    const TriangleMesh mended = solid_of(lacking, &notes);
    for (double z = 0; z < 30; z += 0.7) EXPECT_TRUE(is_within(mended, {0.1, 0.2, z})) << z;
    EXPECT_TRUE(notes.empty());
}

TEST(ContourSolid, AWideGapIsLeftAndSaid) {
    Loops loops;
    for (int z = 0; z <= 30; ++z)
        if (z < 10 || z > 15) loops.push_back(circle({0, 0, 1.0 * z}, 3));
    std::vector<std::string> notes;
    const TriangleMesh solid = solid_of(loops, &notes);
    EXPECT_FALSE(is_within(solid, {0, 0, 12.5}));
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_NE(notes[0].find("no contour over 7.0 mm, where others lie 1.0 mm apart"), std::string::npos) << notes[0];
}

TEST(ContourSolid, ContoursThatStandTwiceOrCrossAreOneAndOnesWithinAreHoles) {
    Loops loops;
    for (int z = 0; z <= 20; ++z) {
        loops.push_back(circle({0, 0, 1.0 * z}, 10));
        loops.push_back(circle({0, 0, 1.0 * z}, 10, z % 2 == 0));  // the same once more
        loops.push_back(circle({9, 0, 1.0 * z}, 5));               // across its rim
        loops.push_back(circle({-4, 0, 1.0 * z}, 3));              // within
        loops.push_back(circle({-4, 0, 1.0 * z}, 1));              // and within that
    }
    const TriangleMesh solid = solid_of(loops);
    for (double z = 1.1; z < 19; z += 2.3) {
        EXPECT_TRUE(is_within(solid, {2, 6, z}));
        EXPECT_TRUE(is_within(solid, {9.2, 0.1, z})) << "where two contours lie over each other";
        EXPECT_TRUE(is_within(solid, {13, 0, z}));
        EXPECT_FALSE(is_within(solid, {-4, 2, z})) << "a hole";
        EXPECT_TRUE(is_within(solid, {-4.1, 0.1, z})) << "an island in it";
        EXPECT_FALSE(is_within(solid, {-12, 0, z}));
    }
}

TEST(ContourSolid, ContoursThatAreNotParallelOrAllAtOneHeightAreRefused) {
    Loops loops{circle({0, 0, 0}, 3), circle({0, 0, 1}, 3), circle({0, 0, 2}, 3)};
    Loops flat(3, circle({0, 0, 0}, 3));
    EXPECT_THROW(solid_of(flat), InputError) << "all at one height";
    Loops begun{{{0, 0, 0}, {1, 1, 0}, {2, 2, 0}}, loops[0], loops[1], loops[2]};
    EXPECT_TRUE(is_within(solid_of(begun), {0, 0, 1})) << "the first has no area";
    loops[2][5].z() += 1;
    EXPECT_THROW(solid_of(loops), InputError);
}

}  // namespace
}  // namespace planlight
