#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "registration/matching/register_with_landmarks.h"
#include "tests/registration/matching/matching_scenes.h"
#include "tests/support/analytic_head.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

/// Clicked on the skin: nasion, outer corners of the eyes, tragi, tip of the nose.
std::vector<PointPair> clicked(const RigidTransform& rig_from_ct, double error_mm, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> off(0, error_mm / std::sqrt(3.));
    std::vector<PointPair> pairs;
    for (const Vector3d& near : {Vector3d(0, -95, 20), Vector3d(48, -80, 15), Vector3d(-48, -80, 15),
                                 Vector3d(75, 5, 0), Vector3d(-75, 5, 0), Vector3d(0, -115, -10)}) {
        const Vector3d p = on_analytic_head(near), miss(off(random), off(random), off(random));
        pairs.push_back({"landmark " + std::to_string(pairs.size() + 1), p, rig_from_ct * p + miss});
    }
    return pairs;
}

std::string told(const RegistrationResult& result) {
    std::string text;
    for (const std::string& reason : result.reasons) text += reason + "; ";
    return text;
}

/// The face from before, the patient's left half under a cloth that hangs 12 to 30 mm above the skin.
PointCloud half_under_cloth(const RigidTransform& rig_from_ct, unsigned seed) {
    PointCloud cloud = head_view(View::front, 180, 15000, seed);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        Vector3d& p = cloud.points_in_rig[i];
        if (p.x() < 0) continue;
        p += (20 + 10 * std::sin(p.x() / 9 + seed) * std::cos(p.z() / 14)) * Vector3d(0, -1, 0);
    }
    return spoiled(moved(cloud, rig_from_ct), 0.3, 0.02, seed);
}

TEST(RegisterWithLandmarks, AScanThatIsRefusedAloneIsFoundWithHelpAndBetterThanByLandmarksAlone) {
    int refused = 0, better = 0;
    for (unsigned seed = 1; seed <= 12; ++seed) {
        const RigidTransform truth = random_pose(seed);
        const PointCloud cloud = half_under_cloth(truth, seed);
        const auto pairs = clicked(truth, 2, seed);
        if (register_patient(cloud, head_lut()).verdict != Verdict::no) continue;
        ++refused;
        const RegistrationResult helped = register_with_landmarks(cloud, head_lut(), pairs);
        ASSERT_EQ(helped.verdict, Verdict::ask) << told(helped);
        EXPECT_NE(told(helped).find("with the help of 6 landmarks"), std::string::npos);
        EXPECT_NE(told(helped).find("the scan alone: "), std::string::npos) << "why it needed help";
        const auto error_of = [&](const RegistrationResult& found) {
            return target_error_mm(found.patient_from_ct.inverse(), truth.inverse(), cloud);
        };
        EXPECT_LT(error_of(helped), 6) << seed;
        better += error_of(helped) < error_of(register_point_pairs(pairs));
    }
    EXPECT_GE(refused, 6) << "the scene must be one that needs help";
    EXPECT_GT(better, refused / 2);
}

TEST(RegisterWithLandmarks, AGoodScanNeedsNoHelpAndIsCheckedByThem) {
    const RigidTransform truth = random_pose(3);
    const PointCloud cloud = spoiled(moved(head_view(View::front, 190, 15000, 3), truth), 0.3, 0.05, 3);
    EXPECT_EQ(register_with_landmarks(cloud, head_lut(), clicked(truth, 1, 3)).verdict, Verdict::yes);
    EXPECT_EQ(register_with_landmarks(cloud, head_lut(), {}).verdict, Verdict::yes);
    auto off = clicked(truth, 1, 3);
    off[1].in_rig += truth.linear() * Vector3d(6, 0, 0);
    const RegistrationResult checked = register_with_landmarks(cloud, head_lut(), off);
    EXPECT_EQ(checked.verdict, Verdict::ask);
    EXPECT_NE(told(checked).find("\"landmark 2\""), std::string::npos);
    EXPECT_NEAR(checked.landmarks_off_mm.value(), 6, 2);
}

TEST(RegisterWithLandmarks, LandmarksThatContradictEachOtherOrTheScanDoNotHelp) {
    const RigidTransform truth = random_pose(4);
    const PointCloud cloud = half_under_cloth(truth, 4);
    ASSERT_EQ(register_patient(cloud, head_lut()).verdict, Verdict::no);
    auto exchanged = clicked(truth, 1, 4);
    std::swap(exchanged[1].in_rig, exchanged[2].in_rig);
    std::swap(exchanged[3].in_rig, exchanged[4].in_rig);
    const RegistrationResult refused = register_with_landmarks(cloud, head_lut(), exchanged);
    EXPECT_EQ(refused.verdict, Verdict::no);
    EXPECT_NE(told(refused).find("the landmarks: "), std::string::npos);
    auto elsewhere = clicked(truth, 1, 4);  // they fit each other, 40 mm off the scan's own place
    for (PointPair& pair : elsewhere) pair.in_rig += truth.linear() * Vector3d(40, 0, 0);
    const RegistrationResult off = register_with_landmarks(cloud, head_lut(), elsewhere);
    EXPECT_EQ(off.verdict, Verdict::no);
    EXPECT_NE(told(off).find("does not fit where 6 landmarks put it"), std::string::npos) << told(off);
}

TEST(RegisterWithLandmarks, AScanOfAnotherThingIsRefusedWithGoodLandmarks) {
    const RigidTransform truth = random_pose(5);
    const RigidTransform on_the_face = truth * Eigen::Translation3d(0, -60, 20);
    const RegistrationResult found =
        register_with_landmarks(moved(sphere_view(45, 15000, 5), on_the_face), head_lut(), clicked(truth, 1, 5));
    EXPECT_EQ(found.verdict, Verdict::no) << told(found);
}

}  // namespace
}  // namespace planlight::test
