#include <gtest/gtest.h>

#include <limits>

#include "registration/matching/contact_triplets.h"
#include "registration/matching/initial_match.h"
#include "registration/matching/surface_sites.h"
#include "tests/registration/matching/matching_scenes.h"

namespace planlight::test {
namespace {

// The start of the ICP, whose basin is some 10 mm and 10 degrees: 3 mm at the targets is well inside.
constexpr double kGoodStart_mm = 3;

/// 24 poses over SO(3), four views, 0.3 to 0.5 mm of noise, 5 to 25 % strays.
class FromAnyPose : public testing::TestWithParam<unsigned> {};

TEST_P(FromAnyPose, TheContactTripletsFindTheHead) {
    const unsigned i = GetParam();
    const double noise_mm = 0.3 + 0.1 * (i % 3), strays = 0.05 + 0.1 * ((i / 4) % 3);
    const RigidTransform rig_from_ct = random_pose(i);
    const PointCloud cloud =
        spoiled(moved(head_view(static_cast<View>(i % 4), 200, 8000, i), rig_from_ct), noise_mm, strays, i);
    const InitialMatch match = find_initial_match(cloud, head_lut());
    ASSERT_FALSE(match.candidates.empty());
    EXPECT_LT(target_error_mm(match.candidates[0].ct_from_rig, rig_from_ct.inverse(), cloud), kGoodStart_mm);
    EXPECT_GE(match.candidates[0].agreeing_bases, 2);
    EXPECT_GT(match.runner_up_ratio, 1.15);
    EXPECT_TRUE(is_rigid(match.candidates[0].ct_from_rig.matrix(), 1e-9));
}
INSTANTIATE_TEST_SUITE_P(Head, FromAnyPose, testing::Range(1u, 25u));

TEST(InitialMatch, IsTheSameForTheSameSeed) {
    const PointCloud cloud = spoiled(moved(head_view(View::left, 160, 6000, 3), random_pose(5)), 0.4, 0.1, 3);
    const InitialMatch first = find_initial_match(cloud, head_lut()), second = find_initial_match(cloud, head_lut());
    ASSERT_EQ(first.candidates.size(), second.candidates.size());
    EXPECT_EQ(first.poses_scored, second.poses_scored);
    for (std::size_t i = 0; i < first.candidates.size(); ++i) {
        EXPECT_EQ(first.candidates[i].cost_mm, second.candidates[i].cost_mm);
        EXPECT_EQ(first.candidates[i].ct_from_rig.matrix(), second.candidates[i].ct_from_rig.matrix());
    }
}

TEST(InitialMatch, CandidatesAreDistinctAndBestFirst) {
    const PointCloud cloud = spoiled(moved(head_view(View::front, 140, 6000, 3), random_pose(6)), 0.4, 0.1, 3);
    const InitialMatch match = find_initial_match(cloud, head_lut());
    ASSERT_GE(match.candidates.size(), 2u);
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const auto& p : cloud.points_in_rig) centre += p / static_cast<double>(cloud.size());
    for (std::size_t i = 0; i < match.candidates.size(); ++i)
        for (std::size_t j = i + 1; j < match.candidates.size(); ++j) {
            const RigidTransform &a = match.candidates[i].ct_from_rig, &b = match.candidates[j].ct_from_rig;
            EXPECT_LE(match.candidates[i].cost_mm, match.candidates[j].cost_mm);
            // Told apart at 8 mm or 8 degrees; the strays move this centre a little against the search's own.
            EXPECT_TRUE((a * centre - b * centre).norm() > 6 || angle_between(a, b) > 0.13) << i << " " << j;
        }
}

TEST(InitialMatch, PointsThatAreNotNumbersDoNotMatter) {
    PointCloud cloud = moved(head_view(View::front, 200, 6000, 3), random_pose(7));
    const RigidTransform truth = random_pose(7).inverse();
    const PointCloud clean = cloud;
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cloud.size(); i += 7) {
        if (i % 2)
            cloud.points_in_rig[i] = {kNaN, 1, kInf};
        else
            cloud.normals_in_rig[i] = {kNaN, kNaN, kNaN};
    }
    cloud.points_in_rig[1] = {1e300, -1e300, 1e12};
    const InitialMatch match = find_initial_match(cloud, head_lut());
    ASSERT_FALSE(match.candidates.empty());
    EXPECT_LT(target_error_mm(match.candidates[0].ct_from_rig, truth, clean), kGoodStart_mm);
}

TEST(InitialMatch, TooFewPointsGiveNoCandidates) {
    EXPECT_TRUE(find_initial_match({}, head_lut()).candidates.empty());
    PointCloud two = head_view(View::front, 200, 2, 1);
    EXPECT_TRUE(find_initial_match(two, head_lut()).candidates.empty());
    PointCloud without_normals = head_view(View::front, 200, 500, 1);
    without_normals.normals_in_rig.clear();
    EXPECT_TRUE(find_initial_match(without_normals, head_lut()).candidates.empty());
    EXPECT_TRUE(find_initial_match(head_view(View::front, 200, 500, 1), SkinLut{}).candidates.empty());
}

TEST(SkinPairs, AWholeBodysAreWorkedOutAsNeededAndAreTheSame) {
    const std::vector<SurfaceSite> skin = sites_of_skin(head_lut(), 10, 1);
    const SkinPairs kept(skin), as_needed(skin, 0);
    std::size_t seen = 0;
    for (std::size_t a = 0; a < skin.size(); a += 7) {
        const SkinPairs::Shape wanted = SkinPairs::shape_of(skin[a], skin[(a * 31 + 5) % skin.size()]);
        std::vector<int> one, other, among;
        kept.find_alike(wanted, a, 7.5f, one);
        as_needed.find_alike(wanted, a, 7.5f, other);
        EXPECT_EQ(one, other);
        as_needed.find_alike(wanted, a, 7.5f, one, among);
        EXPECT_EQ(one, among);
        seen += one.size();
    }
    EXPECT_GT(seen, skin.size());
}

}  // namespace
}  // namespace planlight::test
