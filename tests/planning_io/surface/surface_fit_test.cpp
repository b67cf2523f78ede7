#include "planning_io/surface/surface_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kRadius_mm = 60;

/// A ball of soft tissue in air that grows a little denser inwards, as the skin of most scans does: everywhere within
/// it is brighter under a surface than over it.
Volume ball(const char* modality) {
    constexpr int kVoxels = 80;
    constexpr double kVoxel_mm = 2;
    Volume volume;
    volume.size = {kVoxels, kVoxels, kVoxels};
    volume.ct_from_voxel =
        Eigen::Translation3d(Vector3d::Constant(-(kVoxels - 1) * kVoxel_mm / 2)) * Eigen::Scaling(kVoxel_mm);
    volume.modality = modality;
    volume.is_hu = volume.modality == "CT";
    for (int k = 0; k < kVoxels; ++k)
        for (int j = 0; j < kVoxels; ++j)
            for (int i = 0; i < kVoxels; ++i) {
                const double depth_mm = kRadius_mm - (volume.ct_from_voxel * Vector3d(i, j, k)).norm(),
                             tissue = std::clamp(0.5 + depth_mm / kVoxel_mm, 0.0, 1.0);  // half a voxel of each
                volume.values.push_back(static_cast<float>(-1000 + tissue * (1040 + 2 * std::max(0.0, depth_mm))));
            }
    return volume;
}

TriangleMesh sphere(double radius_mm, const Vector3d& middle = Vector3d::Zero()) {
    constexpr int kRound = 60;
    TriangleMesh mesh;
    for (int i = 1; i < kRound; ++i)
        for (int j = 0; j < 2 * kRound; ++j) {
            const double down = i * std::numbers::pi / kRound, round = j * std::numbers::pi / kRound;
            const Vector3d n(std::sin(down) * std::cos(round), std::sin(down) * std::sin(round), std::cos(down));
            mesh.vertices_in_ct.push_back(middle + radius_mm * n);
            mesh.normals_in_ct.push_back(n);
        }
    return mesh;
}

TEST(SurfaceFit, TheSkinLiesOnAnEdge) {
    const SurfaceFit fit = check_surface_fits(sphere(kRadius_mm), ball("CT"), "skin.stl");
    EXPECT_EQ(fit.share_inside, 1);
    EXPECT_GT(fit.share_darker, 0.99);
    EXPECT_GT(fit.share_on_edge, 0.99);
    EXPECT_LE(fit.median_mm, 0.5);
    EXPECT_EQ(doubt_of(fit, "skin.stl"), "");
}

// 94 % of its size: brighter under it than over it at every point, and nowhere the skin.
TEST(SurfaceFit, WhatLiesUnderTheSkinIsOnNoEdgeThoughItIsBrighterUnderIt) {
    const TriangleMesh small = sphere(0.94 * kRadius_mm);
    const SurfaceFit fit = fit_of(small, ball("CT"));
    EXPECT_GT(fit.share_darker, 0.99);
    EXPECT_LT(fit.share_on_edge, 0.01);
    EXPECT_NEAR(fit.median_mm, 0.06 * kRadius_mm, 0.6);
    EXPECT_THROW(check_surface_fits(small, ball("CT"), "skin.stl"), InputError);
    const SurfaceFit in_mr = check_surface_fits(small, ball("MR"), "skin.stl");
    EXPECT_NE(doubt_of(in_mr, "skin.stl").find("skin.stl: 0 % of its points lie within 2 mm of an edge"),
              std::string::npos)
        << doubt_of(in_mr, "skin.stl");
}

TEST(SurfaceFit, WhatLiesBesideTheVolumeIsRefusedAndAVoxelBeyondItIsNot) {
    const Volume volume = ball("MR");  // its outermost voxel centres lie at 79 mm
    EXPECT_THROW(check_surface_fits(sphere(kRadius_mm, {40, 0, 0}), volume, "skin.stl"), InputError);
    EXPECT_NO_THROW(check_surface_fits(sphere(kRadius_mm, {20.5, 0, 0}), volume, "skin.stl"));
}

}  // namespace
}  // namespace planlight
