#include "planning_io/types/skin_lut.h"

#include <gtest/gtest.h>

#include <cmath>

namespace planlight {
namespace {

/// A field that is linear in space, so that trilinear interpolation gives it exactly: 2x - y + 3z - 5 at 2 mm.
SkinLut linear_field() {
    SkinLut lut;
    lut.origin_in_ct = {10, -20, 30};
    lut.size = {8, 7, 6};
    lut.voxel_mm = 1;
    lut.distance_size = {5, 6, 7};
    lut.distance_voxel_mm = 2;
    for (int k = 0; k < 7; ++k)
        for (int j = 0; j < 6; ++j)
            for (int i = 0; i < 5; ++i) {
                const Eigen::Vector3d p = lut.origin_in_ct + 2.0 * Eigen::Vector3d(i, j, k);
                lut.distance_mm.push_back(static_cast<float>(2 * p.x() - p.y() + 3 * p.z() - 5));
            }
    lut.skin.resize(2);
    lut.skin[0].position_in_ct = {1, 1, 1};
    lut.skin[1].position_in_ct = {2, 2, 2};
    lut.nearest.assign(8 * 7 * 6, 0);
    lut.nearest[3 + 8 * (2 + 7 * 4)] = 1;  // voxel (3,2,4)
    return lut;
}

TEST(SkinLut, ALinearFieldComesBackExactlyWithItsGradient) {
    const SkinLut lut = linear_field();
    for (const auto& p :
         {Eigen::Vector3d(10.3, -19.1, 33.7), Eigen::Vector3d(17.9, -10.1, 41.9), Eigen::Vector3d(10, -20, 30)}) {
        const auto d = lut.signed_distance(p);
        ASSERT_TRUE(d);
        EXPECT_NEAR(d->mm, 2 * p.x() - p.y() + 3 * p.z() - 5, 1e-4);
        EXPECT_LT((d->gradient - Eigen::Vector3d(2, -1, 3)).norm(), 1e-5);
    }
}

TEST(SkinLut, OutsideTheFieldThereIsNoDistance) {
    const SkinLut lut = linear_field();
    EXPECT_FALSE(lut.signed_distance({9.99, -19, 31}));
    EXPECT_FALSE(lut.signed_distance({18.01, -19, 31}));
    EXPECT_FALSE(lut.signed_distance({12, -19, std::nan("")}));
}

TEST(SkinLut, AVoxelReachesHalfItsEdgeRoundItsCentre) {
    const SkinLut lut = linear_field();
    const Eigen::Vector3d centre = lut.origin_in_ct + Eigen::Vector3d(3, 2, 4);
    EXPECT_EQ(lut.nearest_skin(centre), &lut.skin[1]);
    EXPECT_EQ(lut.nearest_skin(centre + Eigen::Vector3d(0.49, -0.49, 0.49)), &lut.skin[1]);
    EXPECT_EQ(lut.nearest_skin(centre + Eigen::Vector3d(0.51, 0, 0)), &lut.skin[0]);
    EXPECT_EQ(lut.nearest_skin(lut.origin_in_ct - Eigen::Vector3d(0.51, 0, 0)), nullptr);
    EXPECT_EQ(lut.nearest_skin({std::nan(""), 0, 0}), nullptr);
}

}  // namespace
}  // namespace planlight
