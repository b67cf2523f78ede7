#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "segmentation/fill_tunnels.h"
#include "segmentation/segment_skin.h"
#include "tests/segmentation/mesh_facts.h"

namespace planlight::test {
namespace {

VoxelGrid cube(int n) {
    return {{n, n, n}, {1, 1, 1}};
}

std::size_t count(const Mask& mask) {
    return static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1));
}

/// A ring round the z axis, thick as `tube`, in a cube of `n` voxels.
Mask ring(int n, double radius, double tube) {
    Mask mask;
    const double c = 0.5 * (n - 1);
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) mask.push_back(std::hypot(std::hypot(i - c, j - c) - radius, k - c) < tube);
    return mask;
}

/// The surface of a mask, made by the product's own way.
MeshFacts surface_of(const Mask& body, const VoxelGrid& grid) {
    Volume volume;
    volume.size = grid.size;
    volume.values.assign(body.size(), -1000);
    SkinMask mask;
    mask.body = body;
    mask.threshold = -480;
    for (std::size_t v = 0; v < body.size(); ++v)
        if (body[v]) volume.values[v] = 40;
    SkinSettings settings;
    settings.max_decimation_error_mm = 0;
    return facts_of(triangulate_skin(volume, mask, settings));
}

TEST(FillTunnels, ARingGetsAMembraneOfOneVoxel) {
    const VoxelGrid grid = cube(31);
    const Mask body = ring(31, 10, 3.2), filled = fill_tunnels(body, grid);
    for (std::size_t v = 0; v < body.size(); ++v) ASSERT_LE(body[v], filled[v]);
    const std::size_t added = count(filled) - count(body);
    EXPECT_GT(added, 100U);  // the hole has a radius of 6.8 voxels: an area of 145
    EXPECT_LT(added, 200U);
}

TEST(FillTunnels, ABallStaysAsItIs) {
    const Mask ball = ring(25, 0, 9.3);
    EXPECT_EQ(fill_tunnels(ball, cube(25)), ball);
}

TEST(FillTunnels, ACavityIsFilledAndASecondPieceDropped) {
    Mask body = ring(25, 0, 9.3);
    const std::size_t middle = 12 * 625 + 12 * 25 + 12;
    body[middle] = body[middle + 1] = 0;
    body[30] = 1;
    const Mask filled = fill_tunnels(body, cube(25));
    EXPECT_EQ(filled, ring(25, 0, 9.3));
}

TEST(FillTunnels, WhatTouchesTheEndOfTheVolumeIsClosedThereToo) {
    Mask body = ring(25, 10, 2.6);
    for (std::size_t v = 0; v < body.size(); ++v)
        if (v / 625 < 12) body[v] = 0;
    body.erase(body.begin(), body.begin() + 12 * 625);  // the ring, cut through its plane: it lies on the first slice
    const VoxelGrid grid{{25, 25, 13}, {1, 1, 1}};
    const Mask filled = fill_tunnels(body, grid);
    EXPECT_GT(count(filled), count(body) + 100);
}

TEST(FillTunnels, RandomSpongesGetASurfaceWithoutHandles) {
    std::mt19937 random(9);
    int with_handles = 0;
    for (int trial = 0; trial < 25; ++trial) {
        const VoxelGrid grid = cube(12);
        std::bernoulli_distribution is(0.35 + 0.012 * trial);
        Mask body(grid.count(), 0);
        for (auto& v : body) v = is(random);
        body = largest_piece(body, grid).mask;
        const Mask filled = fill_tunnels(body, grid);
        for (std::size_t v = 0; v < body.size(); ++v) ASSERT_LE(body[v], filled[v]);
        EXPECT_EQ(fill_tunnels(filled, grid), filled);
        const MeshFacts facts = surface_of(body, grid);
        EXPECT_EQ(facts.bad_edges, 0U) << "trial " << trial;
        EXPECT_EQ(facts.pieces, 1U) << "trial " << trial;
        EXPECT_EQ(facts.euler, 2) << "trial " << trial;
        with_handles += count(filled) > count(body);
    }
    EXPECT_GT(with_handles, 10);
}

}  // namespace
}  // namespace planlight::test
