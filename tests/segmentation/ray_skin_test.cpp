#include "tests/segmentation/ray_skin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "tests/segmentation/off_skin.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr double kRadius_mm = 80;

/// A ball of 80 mm at the origin: `signal` of the depth under its skin (mm, negative outside) and the place, blurred by
/// its eight places a voxel of 1.5 mm, with Rician noise.
Volume ball_of(const std::function<double(double, const Vector3d&)>& signal, double noise = 10,
               const Vector3d& half_mm = {112, 112, 112}) {
    Volume volume;
    volume.modality = "MR";
    volume.ct_from_voxel.linear() *= 1.5;
    volume.ct_from_voxel.translation() = -half_mm;
    for (int a = 0; a < 3; ++a) volume.size[static_cast<std::size_t>(a)] = static_cast<int>(2 * half_mm[a] / 1.5) + 1;
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0, noise);
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                double sum = 0;
                for (int corner = 0; corner < 8; ++corner) {
                    const Vector3d p = volume.ct_from_voxel *
                                       (Vector3d(i, j, k) + 0.5 * Vector3d(corner & 1, (corner >> 1) & 1, corner >> 2) -
                                        Vector3d::Constant(0.25));
                    sum += signal(kRadius_mm - p.norm(), p) / 8;
                }
                volume.values.push_back(static_cast<float>(std::hypot(sum + normal(random), normal(random))));
            }
    return volume;
}

/// A skin of 2 mm, fat, dark bone, brain.
double scalp(double depth) {
    return depth < 0 ? 0 : depth < 2 ? 250 : depth < 6 ? 650 : depth < 13 ? 30 : 300;
}

double one_tissue(double depth) {
    return depth < 0 ? 0 : 400;
}

/// A ball's surface, of a radius for each direction.
TriangleMesh surface_of(const std::function<double(const Vector3d&)>& radius_mm) {
    TriangleMesh mesh;
    constexpr int kRings = 120, kRound = 240;
    const auto at = [](int ring, int round) { return static_cast<std::int32_t>(ring * kRound + round % kRound); };
    for (int ring = 0; ring <= kRings; ++ring)
        for (int round = 0; round < kRound; ++round) {
            const double tilt = M_PI * ring / kRings, turn = 2 * M_PI * round / kRound;
            const Vector3d out(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
            mesh.vertices_in_ct.push_back(radius_mm(out) * out);
            if (ring == kRings) continue;
            mesh.triangles.push_back({at(ring, round), at(ring + 1, round), at(ring + 1, round + 1)});
            mesh.triangles.push_back({at(ring, round), at(ring + 1, round + 1), at(ring, round + 1)});
        }
    mesh.flags.assign(mesh.vertices_in_ct.size(), kSkin);
    return mesh;
}

std::vector<double> depths_of(const std::vector<Vector3d>& points) {
    std::vector<double> mm;
    for (const Vector3d& p : points) mm.push_back(kRadius_mm - p.norm());
    std::sort(mm.begin(), mm.end());
    return mm;
}

TEST(RaySkin, FindsASkinOfOneTissueToATenthOfAVoxel) {
    for (const double noise : {5.0, 40.0}) {
        const auto mm = depths_of(ray_skin(ball_of([](double d, const Vector3d&) { return one_tissue(d); }, noise)));
        ASSERT_GT(mm.size(), 4000U) << noise;
        EXPECT_NEAR(mm[mm.size() / 2], 0, 0.2) << noise;
        EXPECT_GT(mm[mm.size() / 200], -1) << noise;
        EXPECT_LT(mm[mm.size() * 199 / 200], 1) << noise;
    }
}

TEST(RaySkin, FindsADimSkinOverBrightFatAndNotTheFat) {
    const auto mm = depths_of(ray_skin(ball_of([](double d, const Vector3d&) { return scalp(d); })));
    ASSERT_GT(mm.size(), 4000U);
    // The voxels and the mean of five profiles mix fat into the skin: 1.3 mm deep. The half of the fat's crest lies
    // at 2.
    EXPECT_LT(mm[mm.size() / 2], 1.5);
    EXPECT_GT(mm[mm.size() / 200], -0.5);
    EXPECT_LT(mm[mm.size() * 199 / 200], 1.8);
}

TEST(RaySkin, ACoilsShadingOfFourToOneMovesNothing) {
    const auto mm = depths_of(ray_skin(
        ball_of([](double d, const Vector3d& p) { return scalp(d) * std::pow(4, p.x() / (2 * kRadius_mm)); }, 5)));
    EXPECT_GT(mm[mm.size() / 200], -0.5);
    EXPECT_LT(mm[mm.size() * 199 / 200], 1.8);
}

TEST(RaySkin, NothingIsFoundNearASideWhereTheVolumeCutsTheHead) {
    // Left and right the volume ends 60 mm from the middle; there a dark hole of 20 mm looks like air.
    const auto points =
        ray_skin(ball_of([](double d, const Vector3d& p) { return std::hypot(p.y(), p.z()) < 20 ? 0 : one_tissue(d); },
                         5, {60, 112, 112}));
    ASSERT_GT(points.size(), 2000U);
    for (const Vector3d& p : points) {
        if (std::hypot(p.y(), p.z()) > 20) {
            EXPECT_NEAR(p.norm(), kRadius_mm, 2) << p.transpose();
        }
    }
}

TEST(OffSkin, CountsAPatchThatIsOffAndNothingElse) {
    const auto points = ray_skin(ball_of([](double d, const Vector3d&) { return scalp(d); }));
    EXPECT_LT(off_skin(points, surface_of([](const Vector3d&) { return kRadius_mm; })).percent(), 0.1);
    // The whole 4 mm deep, in the fat; and a cap of a twelfth of the ball 4 mm out (noise taken for skin).
    EXPECT_GT(off_skin(points, surface_of([](const Vector3d&) { return kRadius_mm - 4; })).percent(), 95);
    const auto cap = surface_of([](const Vector3d& out) { return kRadius_mm + (out.y() > 5.0 / 6 ? 4 : 0); });
    const auto in_cap =
        std::count_if(points.begin(), points.end(), [](const Vector3d& p) { return p.normalized().y() > 5.0 / 6; });
    EXPECT_NEAR(off_skin(points, cap).percent(),
                100.0 * static_cast<double>(in_cap) / static_cast<double>(points.size()), 1);
}

}  // namespace
}  // namespace planlight::test
