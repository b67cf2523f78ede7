#include "registration/matching/innermost_layer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "registration/matching/refine_icp.h"
#include "registration/matching/register_patient.h"
#include "tests/registration/matching/matching_scenes.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kHole_mm = 55;  // its radius

/// A face in ct; a sheet lies on it round a hole, 0.4 to 1.2 mm above the skin, and rises far aside.
PointCloud under_a_sheet(unsigned seed, double rises_from_mm) {
    PointCloud cloud = test::spoiled(test::head_view(test::View::front, 200, 16000, seed), 0.08, 0, seed);
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& p : cloud.points_in_rig) middle += p / static_cast<double>(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        Vector3d& p = cloud.points_in_rig[i];
        const double aside_mm = std::hypot(p.x() - middle.x(), p.z() - middle.z());
        if (aside_mm < kHole_mm) continue;
        const double gap_mm = 0.8 + 0.4 * std::sin(p.x() / 9) * std::cos(p.z() / 11);
        p += (gap_mm + 0.6 * std::max(0., aside_mm - rises_from_mm)) * cloud.normals_in_rig[i];
    }
    return cloud;
}

bool in_the_hole(const Vector3d& p, const PointCloud& cloud) {
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& q : cloud.points_in_rig) middle += q / static_cast<double>(cloud.size());
    return std::hypot(p.x() - middle.x(), p.z() - middle.z()) < kHole_mm;
}

RigidTransform slightly_off(unsigned seed) {
    RigidTransform off = RigidTransform::Identity();
    off.linear() = Eigen::AngleAxisd(0.005, Vector3d(seed % 2 ? 1 : -1, 0.5, 1).normalized()).toRotationMatrix();
    off.translation() = Vector3d(0.2, -0.4, seed % 3 ? 0.2 : -0.2);
    return off;
}

TEST(InnermostLayer, OfAFaceUnderASheetTheSkinStaysAndTheSheetGoes) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        const PointCloud cloud = under_a_sheet(seed, 1000);
        double skin = 0, sheet = 0, skin_stays = 0, sheet_stays = 0;
        for (const Vector3d& p : cloud.points_in_rig) (in_the_hole(p, cloud) ? skin : sheet) += 1;
        ASSERT_GT(sheet, skin) << "more sheet than skin";
        const auto layer = innermost_layer(cloud, test::head_lut(), slightly_off(seed));
        ASSERT_TRUE(layer);
        ASSERT_EQ(layer->normals_in_rig.size(), layer->size());
        for (const Vector3d& p : layer->points_in_rig) (in_the_hole(p, cloud) ? skin_stays : sheet_stays) += 1;
        EXPECT_GT(skin_stays, 0.85 * skin) << seed;
        EXPECT_LT(sheet_stays, 0.4 * sheet) << seed;
    }
}

TEST(InnermostLayer, SkinAloneStaysAsItIs) {
    const PointCloud cloud = test::spoiled(test::head_view(test::View::front, 180, 12000, 7), 0.1, 0, 7);
    const auto layer = innermost_layer(cloud, test::head_lut(), slightly_off(1));
    EXPECT_TRUE(!layer || static_cast<double>(layer->size()) > 0.95 * static_cast<double>(cloud.size()));
    EXPECT_FALSE(innermost_layer({}, test::head_lut(), slightly_off(1))) << "there is nothing to leave out";
}

/// The sheet is taken neither for skin that swelled nor for a head that lies otherwise.
TEST(InnermostLayer, APatientUnderASheetIsFoundByTheSkinInItsHole) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        const RigidTransform rig_from_ct = test::random_pose(seed);
        const PointCloud cloud = test::moved(under_a_sheet(seed, 75), rig_from_ct);
        const RegistrationResult found = register_patient(cloud, test::head_lut());
        const double with_layers = test::target_error_mm(found.patient_from_ct.inverse(), rig_from_ct.inverse(), cloud);
        EXPECT_NE(found.verdict, Verdict::no) << found.reasons.front();
        EXPECT_LT(with_layers, 0.6) << seed;
        const IcpResult of_all = refine_icp(cloud, test::head_lut(), rig_from_ct.inverse());
        EXPECT_GT(test::target_error_mm(of_all.ct_from_rig, rig_from_ct.inverse(), cloud), 2 * with_layers)
            << "as if the sheet were skin " << seed;
    }
}

}  // namespace
}  // namespace planlight
