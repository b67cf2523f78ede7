// Floods and distances on random masks, against what is worked out voxel by voxel.
#include "segmentation/voxel_morphology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "segmentation/distance_transform.h"

namespace planlight::test {
namespace {

Mask random_mask(const VoxelGrid& grid, double share, unsigned seed) {
    std::mt19937 random(seed);
    std::bernoulli_distribution one(share);
    Mask mask(grid.count());
    for (auto& voxel : mask) voxel = one(random);
    return mask;
}

Eigen::Vector3i place_of(const VoxelGrid& grid, std::size_t v) {
    const std::size_t row = grid.row(), slab = grid.slab();
    return Eigen::Vector3i(static_cast<int>(v % row), static_cast<int>(v % slab / row), static_cast<int>(v / slab));
}

/// What is reached of the 1s from a seed, by asking all pairs until nothing changes.
Mask reached_from(const Mask& mask, const VoxelGrid& grid, std::size_t seed) {
    Mask reached(mask.size(), 0);
    reached[seed] = 1;
    for (bool again = true; again;) {
        again = false;
        for (std::size_t a = 0; a < mask.size(); ++a)
            for (std::size_t b = 0; reached[a] && b < mask.size(); ++b) {
                if (!mask[b] || reached[b] || (place_of(grid, a) - place_of(grid, b)).cwiseAbs().sum() != 1) continue;
                reached[b] = 1;
                again = true;
            }
    }
    return reached;
}

TEST(Flood, ReachesWhatFaceNeighboursReachAndNothingElse) {
    for (unsigned seed = 0; seed < 12; ++seed) {
        const VoxelGrid grid{{7, 6, 5}, Eigen::Vector3d::Ones()};
        const Mask before = random_mask(grid, 0.35 + 0.03 * seed, seed);  // scattered pieces, to one with holes
        const auto begin =
            static_cast<std::size_t>(std::find(before.begin(), before.end(), std::uint8_t{1}) - before.begin());
        Mask after = before;
        std::vector<std::size_t> places;
        const std::size_t changed = flood(after, grid, {begin, begin}, 1, 2, &places);
        const Mask reached = reached_from(before, grid, begin);
        for (std::size_t v = 0; v < before.size(); ++v) EXPECT_EQ(after[v], reached[v] ? 2 : before[v]) << seed;
        EXPECT_EQ(changed, static_cast<std::size_t>(std::count(reached.begin(), reached.end(), 1)));
        std::sort(places.begin(), places.end());
        EXPECT_EQ(std::unique(places.begin(), places.end()), places.end()) << "each voxel once";
        EXPECT_EQ(places.size(), changed);
        for (const std::size_t v : places) EXPECT_EQ(after[v], 2);
    }
}

TEST(Flood, FromASeedOfAnotherValueChangesNothing) {
    const VoxelGrid grid{{3, 1, 1}, Eigen::Vector3d::Ones()};
    Mask mask{1, 0, 1};
    EXPECT_EQ(flood(mask, grid, {1}, 1, 2), 0U);
    EXPECT_EQ(mask, (Mask{1, 0, 1}));
    EXPECT_EQ(flood(mask, grid, {}, 1, 2), 0U);
}

TEST(DistanceFrom, IsThatOfTheNearestVoxelAndNoMoreThanTheLongest) {
    for (unsigned seed = 0; seed < 6; ++seed)
        for (const double longest_mm : {4.0, 40.0}) {
            const VoxelGrid grid{{9, 8, 7}, Eigen::Vector3d(1, 1.5, 0.7)};
            const Mask mask = random_mask(grid, seed == 0 ? 0 : seed == 1 ? 1 : 0.01 * seed, seed);
            const auto found = distance_from(mask, 1, grid, longest_mm);
            for (std::size_t v = 0; v < mask.size(); ++v) {
                double nearest = longest_mm;
                for (std::size_t t = 0; t < mask.size(); ++t)
                    if (mask[t])
                        nearest = std::min(nearest, (place_of(grid, v) - place_of(grid, t))
                                                        .cast<double>()
                                                        .cwiseProduct(grid.spacing_mm)
                                                        .norm());
                ASSERT_NEAR(static_cast<double>(found[v]), nearest, 1e-4) << seed << ", voxel " << v;
            }
        }
}

}  // namespace
}  // namespace planlight::test
