#include "segmentation/head_proportions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "planning_io/volume/read_volume.h"
#include "segmentation/skin_judgement.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

/// A volume whose file says another voxel size is the head stretched along an axis.
TEST(HeadProportions, VoxelsOfAnotherSizeThanTheFileSaysAreDoubted) {
    if (!example_patient()) GTEST_SKIP() << "the package invesalius-examples is not installed";
    const Volume volume = read_volume(*example_patient());
    const auto doubted = [&](int axis, double factor) {
        Volume stretched = volume;
        stretched.ct_from_voxel.linear().col(axis) *= factor;
        const SkinMask mask = segment_skin(stretched);
        const SkinJudgement judged = judge_skin(stretched, mask, triangulate_skin(stretched, mask));
        return std::any_of(judged.doubts.begin(), judged.doubts.end(), [](const SkinDoubt& doubt) {
            return doubt.finding.find("in the file may be wrong") != std::string::npos;
        });
    };
    EXPECT_FALSE(doubted(0, 1)) << "as it is";
    EXPECT_TRUE(doubted(0, 0.7));
    EXPECT_TRUE(doubted(2, 0.7));
    EXPECT_TRUE(doubted(2, 1.5));
}

// A planning CT for a side: the head turned on the table. It is as good a head as the same one that looks ahead.
TEST(HeadProportions, AHeadThatLooksAsideHasNoDoubtsOfItsOwn) {
    if (!example_patient()) GTEST_SKIP() << "the package invesalius-examples is not installed";
    const Volume volume = read_volume(*example_patient());
    const auto doubts_turned_by = [&](double degrees) {
        Volume turned = volume;
        turned.ct_from_voxel = Eigen::AngleAxisd(degrees * M_PI / 180, Eigen::Vector3d::UnitZ()) * volume.ct_from_voxel;
        const SkinMask mask = segment_skin(turned);
        std::vector<std::string> found;
        for (const SkinDoubt& doubt : judge_skin(turned, mask, triangulate_skin(turned, mask)).doubts)
            found.push_back(doubt.finding);
        return found;
    };
    const auto ahead = doubts_turned_by(0);
    for (const double degrees : {30., -60., 75., 90.}) EXPECT_EQ(doubts_turned_by(degrees), ahead) << degrees;
}

TEST(HeadProportions, OfAnEllipsoidAreItsOwn) {
    TriangleMesh mesh;
    const Eigen::Vector3d half(70, 95, 90);
    for (int k = -90; k <= 90; ++k)
        for (int i = 0; i < 720; ++i) {
            const double up = k * 0.01745, round = i * 0.008727;
            mesh.vertices_in_ct.push_back(half.cwiseProduct(
                Eigen::Vector3d(std::cos(up) * std::cos(round), std::cos(up) * std::sin(round), std::sin(up))));
        }
    mesh.flags.assign(mesh.vertices_in_ct.size(), kSkin);
    const auto found = head_proportions(mesh, {70, Eigen::Vector3d::Zero()});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->breadth_of_length, 70. / 95, 0.01);
    EXPECT_NEAR(found->turn, 0, 0.01);
    ASSERT_TRUE(found->height_of_width);
    EXPECT_NEAR(*found->height_of_width, 90 / std::sqrt(70. * 95), 0.08);
    mesh.flags.back() = kCutPlane;  // the crown
    EXPECT_FALSE(head_proportions(mesh, {70, Eigen::Vector3d::Zero()})->height_of_width);
}

}  // namespace
}  // namespace planlight::test
