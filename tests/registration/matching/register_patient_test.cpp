#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>

#include "registration/matching/register_patient.h"
#include "tests/registration/matching/matching_scenes.h"

namespace planlight::test {
namespace {

std::string told(const RegistrationResult& result) {
    std::string text;
    for (const std::string& reason : result.reasons) text += reason + "; ";
    return text;
}

bool mentions(const RegistrationResult& result, const std::string& words) {
    return told(result).find(words) != std::string::npos;
}

PointCloud mirror_image(PointCloud cloud) {
    for (auto& p : cloud.points_in_rig) p.x() = -p.x();
    for (auto& n : cloud.normals_in_rig) n.x() = -n.x();
    return cloud;
}

TEST(RegisterPatient, AWideScanIsAcceptedAndRight) {
    // 0.15 mm: the ICP's tenth of a millimetre, with room for 15 % strays.
    for (unsigned i = 0; i < 8; ++i) {
        const RigidTransform rig_from_ct = random_pose(i + 30);
        const View view = i % 2 ? View::right : View::front;
        const PointCloud cloud = spoiled(moved(head_view(view, 200, 20000, i), rig_from_ct), 0.4, 0.15, i);
        const RegistrationResult result = register_patient(cloud, head_lut());
        EXPECT_EQ(result.verdict, Verdict::yes) << told(result);
        EXPECT_TRUE(result.reasons.empty());
        EXPECT_LT(target_error_mm(result.patient_from_ct.inverse(), rig_from_ct.inverse(), cloud), 0.15);
        EXPECT_GT(result.inlier_fraction, 0.97);  // strays are no evidence
        EXPECT_NEAR(result.scale, 1, 0.005);
        EXPECT_GT(result.mirror_ratio, 1.15);
    }
}

TEST(RegisterPatient, WhatWasSeenThroughTheBodyIsRefused) {
    // The front of the face, seen from before it; then the same points, said to have been seen from behind the head.
    const RigidTransform rig_from_ct = random_pose(7);
    const PointCloud cloud = spoiled(moved(head_view(View::front, 200, 20000, 3), rig_from_ct), 0.3, 0.1, 3);
    RegistrationSettings settings;
    settings.viewpoint_in_rig = rig_from_ct * Eigen::Vector3d(0, -900, 0);
    const RegistrationResult before = register_patient(cloud, head_lut(), settings);
    EXPECT_EQ(before.verdict, Verdict::yes) << told(before);
    EXPECT_LT(before.blocked_fraction.value(), 0.02);
    settings.viewpoint_in_rig = rig_from_ct * Eigen::Vector3d(0, 900, 0);
    const RegistrationResult behind = register_patient(cloud, head_lut(), settings);
    EXPECT_EQ(behind.verdict, Verdict::no);
    EXPECT_TRUE(mentions(behind, "seen through")) << told(behind);
    EXPECT_GT(behind.blocked_fraction.value(), 0.9);
    EXPECT_FALSE(register_patient(cloud, head_lut()).blocked_fraction.has_value());
}

TEST(RegisterPatient, AWrongPoseIsNeverAYes) {
    // Hard scans: 90 to 150 mm, 0.5 mm of noise, 25 % strays, all views.
    for (unsigned i = 0; i < 16; ++i) {
        const RigidTransform rig_from_ct = random_pose(i + 200);
        const PointCloud cloud =
            spoiled(moved(head_view(static_cast<View>(i % 4), 90 + 20 * (i % 4), 6000, i), rig_from_ct), 0.5, 0.25, i);
        const RegistrationResult result = register_patient(cloud, head_lut());
        if (result.verdict == Verdict::yes)
            EXPECT_LT(target_error_mm(result.patient_from_ct.inverse(), rig_from_ct.inverse(), cloud), 1.0) << i;
        else
            EXPECT_FALSE(result.reasons.empty());
    }
}

TEST(RegisterPatient, ABallATubeAndATableAreRefused) {
    EXPECT_EQ(register_patient(sphere_view(80, 10000, 1), head_lut()).verdict, Verdict::no);
    EXPECT_EQ(register_patient(sphere_view(90, 10000, 1), head_lut()).verdict, Verdict::no);
    EXPECT_EQ(register_patient(cylinder_view(80, 160, 10000, 1), head_lut()).verdict, Verdict::no);
    EXPECT_EQ(register_patient(plane_view(150, 10000, 1), head_lut()).verdict, Verdict::no);
}

TEST(RegisterPatient, AMirroredHeadIsRefused) {
    for (unsigned i = 0; i < 4; ++i) {
        const PointCloud cloud = spoiled(mirror_image(head_view(static_cast<View>(i), 200, 12000, i)), 0.4, 0.1, i);
        const RegistrationResult result = register_patient(moved(cloud, random_pose(i)), head_lut());
        EXPECT_EQ(result.verdict, Verdict::no);
        EXPECT_TRUE(mentions(result, "mirror image")) << told(result);
    }
}

TEST(RegisterPatient, AnotherHeadIsNotAYes) {
    // The same head larger or smaller, and stretched along one axis: what a scan of another patient is like.
    for (const Eigen::Vector3d& stretch : {Eigen::Vector3d(1.04, 1.04, 1.04), Eigen::Vector3d(0.95, 0.95, 0.95),
                                           Eigen::Vector3d(1.08, 1, 1), Eigen::Vector3d(1, 0.92, 1.05)}) {
        PointCloud cloud = head_view(View::front, 200, 12000, 1);
        for (auto& p : cloud.points_in_rig) p = p.cwiseProduct(stretch);
        for (auto& n : cloud.normals_in_rig) n = n.cwiseQuotient(stretch).normalized();
        const RegistrationResult result = register_patient(spoiled(cloud, 0.3, 0.05, 1), head_lut());
        EXPECT_NE(result.verdict, Verdict::yes) << stretch.transpose();
    }
}

TEST(RegisterPatient, TooLittleIsRefusedWithTheNumbers) {
    const RegistrationResult empty = register_patient({}, head_lut());
    EXPECT_EQ(empty.verdict, Verdict::no);
    EXPECT_TRUE(mentions(empty, "only 0 points")) << told(empty);
    const RegistrationResult few = register_patient(head_view(View::front, 200, 300, 1), head_lut());
    EXPECT_EQ(few.verdict, Verdict::no);
    EXPECT_TRUE(mentions(few, "only 300 points")) << told(few);
    const RegistrationResult patch = register_patient(head_view(View::front, 50, 4000, 1), head_lut());
    EXPECT_EQ(patch.verdict, Verdict::no);
    EXPECT_TRUE(mentions(patch, "covers only")) << told(patch);
    PointCloud bare = head_view(View::front, 200, 4000, 1);
    bare.normals_in_rig.clear();
    EXPECT_TRUE(mentions(register_patient(bare, head_lut()), "no normals"));
}

TEST(RegisterPatient, NormalsTurnedInwardsAreNotAYes) {
    PointCloud cloud = head_view(View::front, 200, 8000, 1);
    for (auto& n : cloud.normals_in_rig) n = -n;
    EXPECT_NE(register_patient(cloud, head_lut()).verdict, Verdict::yes);
}

TEST(RegisterPatient, ASmoothDomeMayNotBeAccepted) {
    // A scan of the crown only: nearly a ball, it could turn about its own axis.
    const RegistrationResult result =
        register_patient(spoiled(head_view(View::top, 110, 12000, 1), 0.4, 0.1, 1), head_lut());
    EXPECT_NE(result.verdict, Verdict::yes);
    EXPECT_TRUE(mentions(result, "turn about")) << told(result);
}

}  // namespace
}  // namespace planlight::test
