#include "registration/matching/measure_displacement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "registration/matching/refine_icp.h"
#include "registration/matching/refine_pose_deformable.h"
#include "tests/registration/matching/matching_scenes.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

TEST(MeasureDisplacement, FindsASwellingToATwentiethOfAMillimetre) {
    const PointCloud still = head_view(View::front, 190, 40000, 3);
    const Vector3d where = still.points_in_rig[1234];
    const auto swelling = [&](const Vector3d& p) { return 0.3 + 1.5 * std::exp(-(p - where).squaredNorm() / 800); };
    const RigidTransform rig_from_ct = random_pose(4);
    const PointCloud cloud =
        moved(spoiled(displaced(still, [&](auto& p, auto&) { return swelling(p); }), 0.1, 0.05, 5), rig_from_ct);
    const SkinDisplacement found = measure_displacement(cloud, head_lut(), rig_from_ct.inverse());
    ASSERT_TRUE(found.known());
    EXPECT_NEAR(found.offset_mm, 0.3, 0.1);
    const SkinDisplacementField field(found);
    double squares = 0;
    int count = 0;
    for (std::size_t i = 0; i < still.size(); i += 50, ++count)
        squares += std::pow(field.at(still.points_in_rig[i]).mm - swelling(still.points_in_rig[i]), 2);
    EXPECT_LT(std::sqrt(squares / count), 0.05);
}

TEST(MeasureDisplacement, ClothBesideTheSkinIsNotSkin) {
    PointCloud cloud = head_view(View::front, 190, 20000, 6);
    for (std::size_t i = 0; i < cloud.size(); ++i)
        if (cloud.points_in_rig[i].z() > 30) cloud.points_in_rig[i] += 8 * cloud.normals_in_rig[i];  // a cloth over it
    const SkinDisplacement found = measure_displacement(cloud, head_lut(), RigidTransform::Identity());
    ASSERT_TRUE(found.known());
    EXPECT_NEAR(found.offset_mm, 0, 0.03);
    for (const auto& place : found.places) EXPECT_LT(std::abs(place.mm), 2) << place.p_in_ct.transpose();
}

/// A sheet round the head takes nearly all of a scan's points: what is left on the skin lies 3 to 4 mm apart.
TEST(MeasureDisplacement, OfAThinScanIsFoundInLargerPlaces) {
    for (const int points : {6000, 2600, 1500}) {
        const PointCloud cloud = spoiled(
            displaced(head_view(View::front, 190, points, 7), [](auto&, auto&) { return -0.37; }), 0.1, 0.02, 8);
        const SkinDisplacement found = measure_displacement(cloud, head_lut(), RigidTransform::Identity());
        ASSERT_TRUE(found.known()) << points;
        EXPECT_NEAR(found.offset_mm, -0.37, 0.05) << points;
        EXPECT_GT(found.apart_mm, 4) << points;
        const SkinDisplacementField field(found);
        double squares = 0;
        for (const Vector3d& p : cloud.points_in_rig) squares += std::pow(field.at(p).mm + 0.37, 2);
        EXPECT_LT(std::sqrt(squares / points), 0.08) << points;
    }
    const PointCloud dense = head_view(View::front, 190, 40000, 7);
    EXPECT_EQ(measure_displacement(dense, head_lut(), RigidTransform::Identity()).apart_mm, 4);
}

// The scan's own noise, of up to a millimetre a point, is no movement of the skin; waves are as large as without it.
TEST(MeasureDisplacement, TheSpreadOfTheSkinIsWithoutTheScansNoise) {
    const auto spread_of = [](double waves_mm, double noise_mm) {
        const PointCloud cloud = displaced(head_view(View::front, 190, 20000, 9), [&](auto& p, auto&) {
            return waves_mm * (std::sin(p.x() / 12) + std::sin(p.z() / 12));
        });
        const SkinDisplacement found =
            measure_displacement(spoiled(cloud, noise_mm, 0, 10), head_lut(), RigidTransform::Identity());
        EXPECT_TRUE(found.known());
        return std::pair{found.spread_mm, spread_of_skin_mm(found)};
    };
    const auto [with_noise, without] = spread_of(0, 1);
    EXPECT_GT(with_noise, 0.2);
    EXPECT_LT(without, 0.5 * with_noise);
    EXPECT_NEAR(spread_of(0.4, 1).second, spread_of(0.4, 0.05).second, 0.05);
    EXPECT_GT(spread_of(0.4, 0.05).second, 0.33);
    EXPECT_EQ(spread_of_skin_mm({}), 0);
}

TEST(MeasureDisplacement, TooFewPlacesTellNothing) {
    EXPECT_FALSE(
        measure_displacement(head_view(View::front, 20, 2000, 1), head_lut(), RigidTransform::Identity()).known());
    EXPECT_FALSE(measure_displacement({}, head_lut(), RigidTransform::Identity()).known());
}

// Another threshold: skin that faces along the slices' axis moves twice as far. An offset that is alike everywhere
// leaves the head 0.2 mm and more off; 0.1 mm is what noise and the scan's patches leave.
TEST(RefinePoseDeformable, AnotherThresholdMovesSkinUnevenlyAndThePoseStays) {
    for (unsigned seed = 0; seed < 4; ++seed) {
        const RigidTransform rig_from_ct = random_pose(seed), ct_from_rig = rig_from_ct.inverse();
        const PointCloud in_ct = displaced(head_view(seed % 2 ? View::right : View::front, 190, 20000, seed),
                                           [](auto&, auto& n) { return -0.35 * (1 + 1.0 * (n.z() * n.z() - 1. / 3)); });
        const PointCloud cloud = moved(spoiled(in_ct, 0.1, 0.02, seed), rig_from_ct);
        const RigidTransform icp = refine_icp(cloud, head_lut(), ct_from_rig).ct_from_rig;
        const auto error_mm = [&](double share) {
            DeformableSettings settings;
            settings.uneven_share = share;
            return target_error_mm(refine_pose_deformable(cloud, head_lut(), icp, settings).ct_from_rig, ct_from_rig,
                                   cloud);
        };
        const double with = error_mm(DeformableSettings().uneven_share);
        EXPECT_LT(with, 0.15) << seed << ": " << error_mm(1e-3) << " without";
    }
}

}  // namespace
}  // namespace planlight::test
