#include "registration/simulation/head_motion.h"

#include <gtest/gtest.h>

namespace planlight::simulation {

using Eigen::Vector3d;

TEST(HeadMotion, ReachesItsGreatestSpeedAndNeverMore) {
    const Vector3d middle(5, -10, 60), neck(0, 40, -60);
    for (const double speed_mm_s : {5.0, 50.0, 150.0}) {
        std::mt19937 random(3);
        const HeadMotion motion({speed_mm_s, from_seconds(1)}, Instant{}, neck, middle, random);
        double greatest = 0;
        const double step_s = 0.001, until_s = 60 * 50 / speed_mm_s + 5;
        for (double t = 1; t < until_s; t += step_s) {
            const Vector3d moved =
                motion.moved(from_seconds(t + step_s)) * middle - motion.moved(from_seconds(t)) * middle;
            greatest = std::max(greatest, moved.norm() / step_s);
        }
        EXPECT_NEAR(greatest, speed_mm_s, 0.01 * speed_mm_s);
    }
}

TEST(HeadMotion, BeginsFromRestWithoutAJump) {
    std::mt19937 random(4);
    const Vector3d middle(0, 0, 50);
    const HeadMotion motion({80, from_seconds(2)}, Instant{}, Vector3d::Zero(), middle, random);
    EXPECT_TRUE(motion.moved(from_seconds(2)).isApprox(RigidTransform::Identity()));
    // After a hundredth of a second of a half-second ramp to 80 mm/s at most 0.5 * 160 * 0.01^2 mm are covered.
    EXPECT_LT((motion.moved(from_seconds(2.01)) * middle - middle).norm(), 0.009);
    EXPECT_GT((motion.moved(from_seconds(3.0)) * middle - middle).norm(), 1);
}

TEST(HeadHistory, IsContinuousWhereTheMotionChangesAndRemembersThePast) {
    std::mt19937 random(5);
    const Vector3d middle(0, 0, 50), neck(0, 0, -50);
    HeadHistory history(RigidTransform(Eigen::Translation3d(1, 2, 3)));
    history.add(HeadMotion({60, {}}, Instant{}, neck, middle, random), Instant{});
    const RigidTransform early = history.room_from_ct(from_seconds(1)), late = history.room_from_ct(from_seconds(3));
    history.add(HeadMotion({20, {}}, from_seconds(3), neck, middle, random), from_seconds(3));
    EXPECT_TRUE(history.room_from_ct(from_seconds(1)).isApprox(early));
    EXPECT_TRUE(history.room_from_ct(from_seconds(3)).isApprox(late));
    EXPECT_LT((history.room_from_ct(from_seconds(3.02)) * middle - late * middle).norm(), 20 * 0.02);
}

}  // namespace planlight::simulation
