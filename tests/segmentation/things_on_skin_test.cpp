#include "segmentation/things_on_skin.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "tests/segmentation/analytic_heads.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

bool phones(const Vector3d& p, double depth) {
    return std::hypot(p.y(), p.z() + 35) < 40 && std::abs(p.x()) > 40 && depth > -32;
}

TEST(JudgeSkin, SaysThatACushionThatShinesLiesOnTheHead) {
    // 30 mm thick and 110 mm wide, as bright as the scalp, pressed on the back of the head, or on its crown.
    for (const Vector3d& towards : {Vector3d(0, 0.95, 0.3), Vector3d(0.3, 0.4, 0.9)}) {
        const Vector3d out = towards.normalized();
        const auto cushion = [&](const Vector3d& p) {
            const double along = p.dot(out);
            return along > 60 && (p - along * out).norm() < 55 && depth_in_head(p) > -30;
        };
        const Judged head = judged(mr_of(
            [&](const Vector3d& p) {
                const double depth = depth_in_head(p);
                return depth < 0 && cushion(p) ? 900 : layered(depth);
            },
            {125, 145, 135}));
        EXPECT_TRUE(head.refused || doubts(head.skin, "cushion"))
            << towards.transpose() << ": " << head.skin.boneless_cm2 << ", " << head.skin.layered_share;
    }
}

TEST(JudgeSkin, SaysThatACushionLiesAtOneCheek) {
    const Judged head = judged(head_with([](const Vector3d& p, double depth) {
        return p.x() > 35 && p.y() < 10 && p.z() < -20 && p.z() > -80 && depth > -25;
    }));
    EXPECT_TRUE(doubts(head.skin, "one side of the head")) << head.skin.one_sided_cm2;
    EXPECT_LT(judged(mr_of([](const Vector3d& p) { return layered(depth_in_head(p)); })).skin.one_sided_cm2, 3);
}

/// The mirror image of the right side lies where nothing was measured, not in air.
TEST(JudgeSkin, OfAHeadThatTheVolumeCutsAtOneSideNothingIsSaidToLieAtTheOther) {
    const Judged head = judged(mr_of([](const Vector3d& p) { return layered(depth_in_head(p - Vector3d(50, 0, 0))); }));
    EXPECT_TRUE(doubts(head.skin, "cuts off the left side"));
    EXPECT_FALSE(doubts(head.skin, "one side of the head")) << head.skin.one_sided_cm2;
    EXPECT_LT(head.skin.one_sided_cm2, 3);
}

TEST(JudgeSkin, ThatWhatCouldNotBeAskedIsSaidAndIsNoZero) {
    // Above the ears nothing is in the volume: how wide the head is there is not known.
    const Judged head =
        judged(mr_of([](const Vector3d& p) { return layered(depth_in_head(p + Vector3d(0, 0, 20))); }, {105, 125, 40}));
    ASSERT_FALSE(head.refused) << head.skin.refusals.size() << " refusals";
    EXPECT_TRUE(std::isnan(head.skin.width)) << head.skin.width;
    EXPECT_TRUE(doubts(head.skin, "could not be asked"));
}

TEST(JudgeSkin, SaysThatThingsLieAtBothEars) {
    const Judged head = judged(head_with(phones));
    EXPECT_TRUE(doubts(head.skin, "at both sides")) << head.skin.width;
    EXPECT_LT(judged(mr_of([](const Vector3d& p) { return layered(depth_in_head(p)); })).skin.width, 1.2);
}

TEST(JudgeSkin, SaysThatACushionLiesBehindTheNeck) {
    const Judged head = judged(head_with([](const Vector3d& p, double depth) {
        return p.y() > 10 && depth > -40 && std::abs(p.x()) < 60 && p.z() < -45;
    }));
    EXPECT_TRUE(doubts(head.skin, "Behind the neck")) << head.skin.shelf_cm2;
    EXPECT_LT(judged(mr_of([](const Vector3d& p) { return layered(depth_in_head(p)); })).skin.shelf_cm2, 3);
}

TEST(JudgeSkin, SaysThatACushionLiesOnTheHeadWhereACtEndsWithinIt) {
    const auto cushion = [](const Vector3d& p, double depth) {
        return p.y() > 50 && depth > -40 && std::abs(p.x()) < 55 && std::abs(p.z()) < 45 ? 20 : -1000;
    };
    const Judged head = judged(ct_of(cushion, {105, 118, 115}));
    EXPECT_TRUE(doubts(head.skin, "At the back the volume ends")) << head.skin.cut_sides.size() << " ends";
}

/// Through the brain, with bone round it; and through the scalp, with bone under it.
TEST(JudgeSkin, OfAHeadThatACtCutsOffNothingIsSaidToLieOnIt) {
    for (const double back_mm : {60.0, 89.0}) {
        const Judged head = judged(ct_of([](const Vector3d&, double) { return -1000; }, {105, back_mm, 115}));
        EXPECT_TRUE(doubts(head.skin, "cuts off the back"));
        EXPECT_FALSE(doubts(head.skin, "no bone under it")) << back_mm;
    }
}

TEST(JudgeSkin, SaysWhereHairOrAClothLiesOnTheHeadInACt) {
    const auto cloth = [](const Vector3d& p, double depth) { return depth > -6 && p.z() > 40 ? -350 : -1000; };
    const Judged head = judged(ct_of(cloth, {105, 125, 115}));
    EXPECT_TRUE(doubts(head.skin, "most at the crown")) << head.skin.light_cm2 << " " << head.skin.light_at;
    const Judged bare = judged(ct_of([](const Vector3d&, double) { return -1000; }, {105, 125, 115}));
    EXPECT_EQ(bare.skin.light_cm2, 0);
    for (const SkinDoubt& d : bare.skin.doubts) ADD_FAILURE() << d.finding;
}

TEST(JudgeSkin, SaysThatSmallThingsStandOutFromTheUpperHead) {
    // Knobs of 14 mm, 8 mm high, some 40 mm apart.
    const Judged head = judged(head_with([](const Vector3d& p, double depth) {
        const double round = std::atan2(p.y(), p.x()), up = std::asin(p.z() / p.norm());
        const double along = std::remainder(round * std::cos(up) * 95, 40), across = std::remainder(up * 95, 40);
        return p.z() > 0 && depth > -8 && std::hypot(along, across) < 7;
    }));
    EXPECT_TRUE(head.refused || doubts(head.skin, "Small things")) << head.skin.bumps_cm2;
    EXPECT_LT(judged(mr_of([](const Vector3d& p) { return layered(depth_in_head(p)); })).skin.bumps_cm2, 3);
}

TEST(JudgeSkin, SaysThatSomethingLiesOnItAllOver) {
    const Judged head = judged(mr_of([](const Vector3d& p) {
        const double depth = depth_in_head(p);
        return depth < 0 ? 0.0 : depth < 14 ? 900.0 : depth < 22 ? 40.0 : 500.0;
    }));
    EXPECT_TRUE(head.refused || doubts(head.skin, "all over")) << head.skin.scalp_mm;
}

TEST(JudgeSkin, SaysThatAStrapHangsOnTheHead) {
    // 8 mm thick, from above the ear 110 mm upwards, standing off.
    const Judged head = judged(mr_of([](const Vector3d& p) {
        const double depth = depth_in_head(p);
        const bool strap = std::hypot(p.x() - 92, p.y()) < 5 && p.z() > -20 && p.z() < 90;
        const bool bridge = std::hypot(p.z() + 15, p.y()) < 7 && p.x() > 60 && p.x() < 95;
        return depth < 0 && (strap || bridge) ? 900 : layered(depth);
    }));
    EXPECT_TRUE(head.refused || doubts(head.skin, "hangs") || head.skin.strand_mm < 15)  // said, or cut off
        << head.skin.strand_mm;
    EXPECT_LT(judged(mr_of([](const Vector3d& p) { return layered(depth_in_head(p)); })).skin.strand_mm, 40);
}

TEST(JudgeSkin, TheSkullsMiddleIsSoughtInWhatTheVolumeShows) {
    // On a turned grid the corners of the skin's box lie beyond the volume's sides.
    const SkinJudgement skin = judged(head_with(phones, 45)).skin;
    EXPECT_LT(skin.ball_centre_in_ct.norm(), 25) << skin.ball_centre_in_ct.transpose();
    EXPECT_GT(skin.layered_share, 0.8);
}

}  // namespace
}  // namespace planlight::test
