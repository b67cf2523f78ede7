#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "registration/matching/match_evidence.h"
#include "registration/matching/refine_icp.h"
#include "registration/matching/refine_pose_deformable.h"
#include "registration/matching/smooth_deformation.h"
#include "tests/registration/matching/matching_scenes.h"
#include "tests/registration/matching/moved_skin.h"

namespace planlight::test {
namespace {

struct Settled {
    DeformablePose pose;
    double before_mm, after_mm;  ///< target error of the ICP, and after settling
    double bound_mm;             ///< predicted for a target 60 mm under the scan
};

Settled settle(const std::string& movement, double rms_mm, double noise_mm, unsigned seed) {
    const RigidTransform rig_from_ct = random_pose(seed), ct_from_rig = rig_from_ct.inverse();
    const View view = seed % 2 ? View::right : View::front;
    PointCloud in_ct = head_view(view, 190, 12000, seed);
    if (rms_mm > 0) in_ct = with_moved_skin(in_ct, movement, rms_mm, seed);
    const PointCloud cloud = moved(spoiled(in_ct, noise_mm, 0.1, seed), rig_from_ct);
    const IcpResult icp = refine_icp(cloud, head_lut(), ct_from_rig);
    Settled result{refine_pose_deformable(cloud, head_lut(), icp.ct_from_rig),
                   target_error_mm(icp.ct_from_rig, ct_from_rig, cloud), 0, 0};
    result.after_mm = target_error_mm(result.pose.ct_from_rig, ct_from_rig, cloud);
    Eigen::Vector3d target = result.pose.covariance.centre_in_ct;
    target += (view == View::front ? Eigen::Vector3d(0, 60, 0) : Eigen::Vector3d(60, 0, 0));
    result.bound_mm = predicted_error(result.pose.covariance, target).bound_95_mm;
    return result;
}

TEST(RefinePoseDeformable, SkinThatIsThickerAllOverIsToldFromAShiftOfTheHead) {
    // A skin 1 mm outside of the CT's: the ICP shifts the head towards the devices, by up to that millimetre.
    double before_mm = 0, after_mm = 0;
    for (unsigned seed = 0; seed < 6; ++seed) {
        const Settled s = settle("thicker all over", 1, 0.2, seed);
        EXPECT_NEAR(std::abs(s.pose.offset_mm), 1, 0.2);
        before_mm += s.before_mm / 6;
        after_mm += s.after_mm / 6;
    }
    EXPECT_LT(after_mm, 0.5 * before_mm);
    EXPECT_LT(after_mm, 0.35);
}

TEST(RefinePoseDeformable, StillSkinIsSaidToBeStillAndItsPoseIsKept) {
    for (unsigned seed = 0; seed < 4; ++seed) {
        const Settled s = settle("", 0, 0.2, seed);
        EXPECT_LT(s.pose.movement_mm, 0.2);
        EXPECT_LT(s.after_mm, 0.15);
        EXPECT_GT(s.bound_mm, s.after_mm);
        EXPECT_LT(s.bound_mm, 1) << "nobody looks at a bound that is always large";
    }
}

// The rims of what was glossy, a nostril's edge: a few places of a clean scan lie off by much more than all else does.
TEST(RefinePoseDeformable, AFewPlacesThatAreOffDoNotPullACleanScan) {
    for (unsigned seed = 28; seed < 36; ++seed) {
        const RigidTransform rig_from_ct = random_pose(seed), ct_from_rig = rig_from_ct.inverse();
        PointCloud in_ct = head_view(View::front, 190, 12000, seed);
        std::mt19937 random(seed);
        std::uniform_int_distribution<std::size_t> any(0, in_ct.size() - 1);
        std::uniform_real_distribution<double> off(-0.9, 0.4);
        for (int rim = 0; rim < 8; ++rim) {
            const Eigen::Vector3d middle = in_ct.points_in_rig[any(random)];
            const double by_mm = off(random);
            for (std::size_t i = 0; i < in_ct.size(); ++i)
                if ((in_ct.points_in_rig[i] - middle).norm() < 7) {
                    const SkinPoint* s = head_lut().nearest_skin(in_ct.points_in_rig[i]);
                    if (s) in_ct.points_in_rig[i] += by_mm * s->normal_in_ct.cast<double>();
                }
        }
        const PointCloud cloud = moved(spoiled(in_ct, 0.03, 0, seed), rig_from_ct);
        const IcpResult icp = refine_icp(cloud, head_lut(), ct_from_rig);
        const DeformablePose settled = refine_pose_deformable(cloud, head_lut(), icp.ct_from_rig);
        EXPECT_LT(target_error_mm(settled.ct_from_rig, ct_from_rig, cloud), 0.15) << seed;
    }
}

TEST(RefinePoseDeformable, TheBoundHoldsWhereSkinMovedInWavesAndGrowsWithThem) {
    // "Waves of 50 mm" were not looked at when the bound was made. 19 of 20 are to be within; 17 or fewer by chance: 8
    // %, 16 or fewer: 2 %.
    int within = 0;
    double small_mm = 0, large_mm = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        const Settled s = settle("waves of 50 mm", seed < 10 ? 0.2 : 1, 0.3, seed + 40);
        within += s.after_mm <= s.bound_mm;
        (seed < 10 ? small_mm : large_mm) += s.bound_mm / 10;
    }
    EXPECT_GE(within, 17);
    EXPECT_GT(large_mm, 2 * small_mm);
}

TEST(RefinePoseDeformable, TooLittleSkinToTellIsAnInfiniteBoundNotASmallOne) {
    const PointCloud cloud = head_view(View::front, 25, 300, 1);
    const DeformablePose pose = refine_pose_deformable(cloud, head_lut(), RigidTransform::Identity());
    EXPECT_LT(pose.patches, 24);
    EXPECT_FALSE(std::isfinite(predicted_error(pose.covariance, Eigen::Vector3d::Zero()).bound_95_mm));
    EXPECT_TRUE(pose.ct_from_rig.isApprox(RigidTransform::Identity()));
}

// A scan of 1 to 2 points in a patch lost nearly all of it, and nothing was known of a head that is well scanned; its
// shape was taken for right, for nobody had looked.
TEST(RefinePoseDeformable, AThinScanIsGatheredInLargerPatchesAndItsShapeIsLookedAt) {
    for (const int points : {1000, 1400, 2000, 20000}) {
        const PointCloud cloud = spoiled(head_view(View::front, 190, points, 7), 0.2, 0, 8);
        const DeformablePose pose = refine_pose_deformable(cloud, head_lut(), RigidTransform::Identity());
        EXPECT_GE(pose.patches, 60) << points;
        EXPECT_LT(predicted_error(pose.covariance, pose.covariance.centre_in_ct).bound_95_mm, 1.2) << points;
        const auto shape = fit_smooth_deformation(cloud, head_lut(), RigidTransform::Identity());
        ASSERT_TRUE(shape) << points;
        EXPECT_LT(shape->probability() * shape->p95_mm, 0.6) << points;
    }
}

TEST(RefinePoseDeformable, OfTooLittleSkinTheShapeIsNotKnown) {
    EXPECT_FALSE(
        fit_smooth_deformation(head_view(View::front, 25, 300, 1), head_lut(), RigidTransform::Identity()).has_value());
}

TEST(RefinePoseDeformable, TheScanStillLiesOnTheSkinAfterwards) {
    // A round crown, noisy: shift, offset, growth and long waves can stand for each other, and any of them is found
    // large.
    for (unsigned seed = 0; seed < 12; ++seed) {
        const RigidTransform rig_from_ct = random_pose(seed), ct_from_rig = rig_from_ct.inverse();
        const PointCloud in_ct = with_moved_skin(head_view(View::top, 150, 20000, seed), "waves of 25 mm", 0.9, seed);
        const PointCloud cloud = moved(spoiled(in_ct, 1, 0.2, seed), rig_from_ct);
        const RigidTransform icp = refine_icp(cloud, head_lut(), ct_from_rig).ct_from_rig;
        const DeformablePose settled = refine_pose_deformable(cloud, head_lut(), icp);
        const double before_mm = lay_on_skin(cloud, head_lut(), icp, 1.5).median_mm;
        const double after_mm = lay_on_skin(cloud, head_lut(), settled.ct_from_rig, 1.5, settled.offset_mm).median_mm;
        EXPECT_LT(after_mm, 1.5 * before_mm + 0.2) << "seed " << seed << ", offset " << settled.offset_mm;
    }
}

TEST(RefinePoseDeformable, SkinThatIsThickOverTheBoneIsTrustedLess) {
    // Thin over the skull, thick below it, as cheeks are; only the thick skin moved, by waves of 1.5 mm rms.
    SkinLut thick_below = head_lut();
    for (SkinPoint& s : thick_below.skin) s.thickness_mm = s.position_in_ct.z() > 0 ? 3.f : 20.f;
    double known_mm = 0, unknown_mm = 0;
    for (unsigned seed = 0; seed < 12; ++seed) {
        const RigidTransform rig_from_ct = random_pose(seed), ct_from_rig = rig_from_ct.inverse();
        PointCloud in_ct = head_view(seed % 2 ? View::right : View::front, 190, 12000, seed);
        const PointCloud all_moved = with_moved_skin(in_ct, "waves of 50 mm", 1.5, seed);
        for (std::size_t i = 0; i < in_ct.size(); ++i)
            if (in_ct.points_in_rig[i].z() < 0) in_ct.points_in_rig[i] = all_moved.points_in_rig[i];
        const PointCloud cloud = moved(spoiled(in_ct, 0.2, 0.05, seed), rig_from_ct);
        const auto error_mm = [&](const SkinLut& lut) {
            return target_error_mm(refine_pose_deformable(cloud, lut, ct_from_rig).ct_from_rig, ct_from_rig, cloud) /
                   12;
        };
        known_mm += error_mm(thick_below);
        unknown_mm += error_mm(head_lut());
    }
    EXPECT_LT(known_mm, 0.8 * unknown_mm) << known_mm << " against " << unknown_mm;
}

}  // namespace
}  // namespace planlight::test
