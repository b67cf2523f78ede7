#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "registration/matching/cloud_normals.h"
#include "registration/matching/point_pairs.h"
#include "registration/matching/register_patient.h"
#include "tests/registration/matching/matching_scenes.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

/// Nasion, both outer eye corners, both tragi, tip of the nose: of a head about its middle (ct, mm).
const std::vector<Vector3d> kLandmarks{{0, -95, 20}, {48, -80, 15}, {-48, -80, 15},
                                       {75, 5, 0},   {-75, 5, 0},   {0, -115, -10}};

std::vector<PointPair> touched(const RigidTransform& rig_from_ct, double error_mm, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> off(0, error_mm / std::sqrt(3.));
    std::vector<PointPair> pairs;
    for (const Vector3d& p : kLandmarks) {
        const Vector3d miss(off(random), off(random), off(random));
        pairs.push_back({"landmark " + std::to_string(pairs.size() + 1), p, rig_from_ct * p + miss});
    }
    return pairs;
}

bool says(const RegistrationResult& result, const std::string& words) {
    for (const auto& reason : result.reasons)
        if (reason.find(words) != std::string::npos) return true;
    return false;
}

TEST(PointPairs, ExactLandmarksGiveTheExactPoseButNeverAYes) {
    const RigidTransform truth = random_pose(5);
    const RegistrationResult result = register_point_pairs(touched(truth, 0, 1));
    EXPECT_EQ(result.verdict, Verdict::ask) << "a small residual is no proof";
    EXPECT_FALSE(says(result, "does not fit the others")) << "none is off by more than a last digit";
    EXPECT_TRUE(result.patient_from_ct.isApprox(truth, 1e-9));
}

TEST(PointPairs, TheErrorAtATargetIsWithinTheBoundInNineteenOfTwenty) {
    // 2 mm of touching error; a target at the pituitary gland, 80 mm behind the landmarks' front.
    const Vector3d target(0, -10, -5);
    int within = 0;
    double largest_mm = 0;
    for (unsigned seed = 0; seed < 400; ++seed) {
        const RigidTransform truth = random_pose(seed);
        const RegistrationResult result = register_point_pairs(touched(truth, 2, seed));
        const double error_mm = (result.patient_from_ct * target - truth * target).norm();
        within += error_mm <= predicted_error(result.covariance, target).bound_95_mm;
        largest_mm = std::max(largest_mm, predicted_error(result.covariance, target).bound_95_mm);
    }
    EXPECT_GE(within, 0.90 * 400);
    EXPECT_LT(largest_mm, 6) << "a bound that says nothing would cover everything";
}

TEST(PointPairs, ALandmarkThatDoesNotFitIsNamed) {
    auto pairs = touched(random_pose(8), 0.5, 2);
    pairs[3].in_rig += Vector3d(0, 0, 12);
    EXPECT_TRUE(says(register_point_pairs(pairs), "\"landmark 4\""));
}

TEST(PointPairs, LeftAndRightExchangedIsRefused) {
    auto pairs = touched(random_pose(9), 0.5, 3);
    std::swap(pairs[1].in_rig, pairs[2].in_rig);
    std::swap(pairs[3].in_rig, pairs[4].in_rig);
    EXPECT_EQ(register_point_pairs(pairs).verdict, Verdict::no);
}

TEST(PointPairs, TwoLandmarksOrAllOnALineAreRefused) {
    auto pairs = touched(random_pose(10), 0.5, 4);
    EXPECT_EQ(register_point_pairs({pairs[0], pairs[1]}).verdict, Verdict::no);
    for (std::size_t i = 0; i < pairs.size(); ++i)
        pairs[i].in_ct = pairs[i].in_rig = Vector3d(20. * static_cast<double>(i), 1, 2);
    EXPECT_TRUE(says(register_point_pairs(pairs), "on one line"));
}

TEST(PointPairs, ALandmarkHeldAgainstAMatchLowersItsVerdictByItsName) {
    RegistrationResult found;
    found.verdict = Verdict::yes;
    found.patient_from_ct = random_pose(11);
    const auto good = touched(found.patient_from_ct, 1, 5);
    RegistrationResult checked = found;
    check_with_point_pairs(good, checked);
    EXPECT_EQ(checked.verdict, Verdict::yes);
    auto off = good;
    off[2].in_rig += Vector3d(6, 0, 0);
    check_with_point_pairs(off, checked);
    EXPECT_EQ(checked.verdict, Verdict::ask);
    EXPECT_TRUE(says(checked, "\"landmark 3\""));
    off[2].in_rig += Vector3d(20, 0, 0);
    checked = found;
    check_with_point_pairs(off, checked);
    EXPECT_EQ(checked.verdict, Verdict::no);
}

TEST(CloudNormals, ABallsPointsGetItsNormals) {
    PointCloud cloud = sphere_view(80, 12000, 3);
    const std::vector<Vector3d> truth = cloud.normals_in_rig;
    cloud.normals_in_rig.clear();
    const PointCloud found = with_normals(cloud, {0, -900, 0});
    ASSERT_GT(found.size(), 11900u);
    ASSERT_EQ(found.size(), found.normals_in_rig.size());
    int wrong = 0;
    for (std::size_t i = 0; i < found.size(); ++i)  // 10 degrees; the rim has neighbours on one side only
        wrong += found.normals_in_rig[i].dot(found.points_in_rig[i].normalized()) < std::cos(0.17);
    EXPECT_LT(wrong, static_cast<int>(found.size() / 100));
}

TEST(CloudNormals, AScanWithoutNormalsIsRegisteredAllTheSame) {
    PointCloud in_ct = head_view(View::front, 190, 20000, 2);
    const RigidTransform rig_from_ct = random_pose(77);
    Vector3d out = Vector3d::Zero();
    for (const Vector3d& n : in_ct.normals_in_rig) out += n;
    const Vector3d viewpoint = rig_from_ct * Vector3d(in_ct.points_in_rig[0] + 900 * out.normalized());
    PointCloud cloud = spoiled(moved(in_ct, rig_from_ct), 0.2, 0.05, 3);
    cloud.normals_in_rig.clear();
    const RegistrationResult result = register_patient(with_normals(cloud, viewpoint), head_lut());
    EXPECT_EQ(result.verdict, Verdict::yes);
    EXPECT_LT(target_error_mm(result.patient_from_ct.inverse(), rig_from_ct.inverse(), cloud), 0.2);
}

}  // namespace
}  // namespace planlight::test
