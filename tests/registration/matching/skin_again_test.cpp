#include "registration/matching/skin_again.h"

#include <gtest/gtest.h>

#include "registration/matching/measure_displacement.h"
#include "tests/registration/matching/matching_scenes.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr double kCloth_mm = 5;

/// A face of which a part is skin, and the rest lies under cloth that takes most of the points.
struct FaceAndCloth {
    PointCloud skin, all;
    FaceAndCloth() {
        const PointCloud head = spoiled(head_view(View::front, 190, 30000, 5), 0.2, 0, 6);
        for (std::size_t i = 0; i < head.size(); ++i) {
            const bool bare = head.points_in_rig[i].z() < 0;
            if (bare && i % 6 != 0) continue;
            all.points_in_rig.push_back(head.points_in_rig[i] + (bare ? 0 : kCloth_mm) * head.normals_in_rig[i]);
            all.normals_in_rig.push_back(head.normals_in_rig[i]);
            if (!bare) continue;
            skin.points_in_rig.push_back(all.points_in_rig.back());
            skin.normals_in_rig.push_back(all.normals_in_rig.back());
        }
    }
};

// A match found among cloth was never resumed: the median of the whole scan is that of the cloth.
TEST(SkinAgain, ClothBesideTheSkinDoesNotSayThatTheSkinLiesElsewhere) {
    const FaceAndCloth face;
    ASSERT_LT(3 * face.skin.size(), face.all.size()) << "most is cloth; else this test tells nothing";
    const RigidTransform rig_from_ct = random_pose(3);
    const SkinDisplacement found = measure_displacement(face.skin, head_lut(), RigidTransform::Identity());
    ASSERT_TRUE(found.known());
    const PointCloud later = moved(face.all, rig_from_ct);
    const SkinAgain again = skin_again(later, head_lut(), rig_from_ct.inverse(), found, 0);
    EXPECT_LT(again.median_mm, 0.3);
    EXPECT_GT(static_cast<double>(again.cloud.size()), 0.6 * static_cast<double>(face.skin.size()));
    EXPECT_GT(skin_again(later, head_lut(), rig_from_ct.inverse(), {}, 0).median_mm, kCloth_mm - 1)
        << "it is the place that tells them apart";
}

TEST(SkinAgain, AHeadThatMovedAgainstItsMarkersShowsAllTheSame) {
    const FaceAndCloth face;
    const SkinDisplacement found = measure_displacement(face.skin, head_lut(), RigidTransform::Identity());
    for (const double mm : {20.0, 33.0})  // from nearer by the fine match finds the way back, and says how far it is
        for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)}) {
            RigidTransform slid = RigidTransform::Identity();
            slid.translation() = mm * way;
            const SkinAgain again = skin_again(moved(face.all, slid), head_lut(), RigidTransform::Identity(), found, 0);
            EXPECT_TRUE(again.median_mm > 1.3 || again.cloud.size() < face.skin.size() / 2)
                << mm << " mm along " << way.transpose() << ": " << again.median_mm << " mm, " << again.cloud.size()
                << " of " << face.skin.size();
        }
}

TEST(SkinAgain, DistancesAreCountedFromWhereTheMatchFoundTheSkin) {
    PointCloud swollen = head_view(View::front, 190, 5000, 5);
    for (std::size_t i = 0; i < swollen.size(); ++i) swollen.points_in_rig[i] += 1.2 * swollen.normals_in_rig[i];
    EXPECT_NEAR(skin_again(swollen, head_lut(), RigidTransform::Identity(), {}, 0).median_mm, 1.2, 0.1);
    EXPECT_LT(skin_again(swollen, head_lut(), RigidTransform::Identity(), {}, 1.2).median_mm, 0.1);
}

}  // namespace
}  // namespace planlight::test
