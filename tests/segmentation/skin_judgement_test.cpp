#include "segmentation/skin_judgement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>

#include "planning_io/types/error.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

/// An MR of 3 mm voxels of what `signal` says at a place (mm, the middle is the origin, the front is at negative y),
/// with Rician noise. The grid may be turned about the body's long axis.
Volume mr_of(const std::function<double(const Vector3d&)>& signal, const Vector3d& half_mm = {105, 125, 115},
             double noise = 12, double turn_degrees = 0) {
    Volume volume;
    volume.modality = "MR";
    volume.ct_from_voxel = Eigen::AngleAxisd(turn_degrees * std::numbers::pi / 180, Vector3d::UnitZ()) *
                           Eigen::Translation3d(-half_mm) * Eigen::Scaling(3.0);
    for (int a = 0; a < 3; ++a) volume.size[static_cast<std::size_t>(a)] = static_cast<int>(2 * half_mm[a] / 3) + 1;
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0, noise);
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i)
                volume.values.push_back(static_cast<float>(
                    std::hypot(signal(volume.ct_from_voxel * Vector3d(i, j, k)) + normal(random), normal(random))));
    return volume;
}

/// Depth under an egg of 75 x 92 x 85 mm, with a nose unless it was taken away; negative outside.
double depth_in_head(const Vector3d& p, bool nose = true) {
    const double egg = 80 * (1 - Vector3d(p.x() / 75, p.y() / 92, p.z() / 85).norm());
    return nose ? std::max(egg, 12 - (p - Vector3d(0, -100, -30)).norm()) : egg;
}

double layered(double depth) {
    return depth < 0 ? 0 : depth < 6 ? 900 : depth < 13 ? 40 : 500;
}

struct Judged {
    SkinJudgement skin;
    bool refused = false;
};

Judged judged(const Volume& volume) {
    const SkinMask mask = segment_skin(volume);
    Judged result{judge_skin(volume, mask, triangulate_skin(volume, mask)), false};
    result.refused = !result.skin.refusals.empty();
    return result;
}

bool doubts(const SkinJudgement& skin, const std::string& word) {
    return std::any_of(skin.doubts.begin(), skin.doubts.end(),
                       [&](const SkinDoubt& d) { return d.finding.find(word) != std::string::npos; });
}

TEST(JudgeSkin, AHeadWithScalpBoneBrainAndNoseHasNoDoubts) {
    const Judged head = judged(mr_of([](const Vector3d& p) { return layered(depth_in_head(p)); }));
    EXPECT_FALSE(head.refused);
    for (const SkinDoubt& d : head.skin.doubts) ADD_FAILURE() << d.finding;
    EXPECT_GT(head.skin.layered_share, 0.8);
    EXPECT_NEAR(head.skin.ball_radius_mm, 75, 5);
}

/// What a converter does that loses the direction of an axis or two.
TEST(JudgeSkin, AHeadThatLiesOtherwiseThanItsHeaderSaysIsTold) {
    const auto turned_by = [](const Vector3d& signs) {
        return judged(mr_of([&](const Vector3d& p) { return layered(depth_in_head(signs.cwiseProduct(p))); })).skin;
    };
    EXPECT_FALSE(doubts(turned_by({1, 1, 1}), "By its header"));
    EXPECT_TRUE(doubts(turned_by({1, 1, -1}), "the head is upside down, where"));
    EXPECT_TRUE(doubts(turned_by({1, -1, -1}), "the head is upside down and looks to the back"));
    EXPECT_TRUE(doubts(turned_by({1, -1, 1}), "the head looks to the back"));
    const Judged faceless = judged(mr_of([](const Vector3d& p) { return layered(depth_in_head(p, false)); }));
    EXPECT_FALSE(doubts(faceless.skin, "By its header"));
}

TEST(JudgeSkin, ASecondHeadInTheVolumeIsTold) {
    const auto beside = [](double scale) {  // a head of this size beside one of usual size
        return judged(mr_of(
            [scale](const Vector3d& p) {
                const Vector3d other = (p + Vector3d(100, 0, 0)) / scale;
                return layered(std::max(depth_in_head(p - Vector3d(100, 0, 0)), scale * depth_in_head(other)));
            },
            {205, 125, 115}));
    };
    const Judged two = beside(0.9);
    EXPECT_TRUE(doubts(two.skin, "Beside the head")) << two.skin.beside_mm;
    EXPECT_FALSE(doubts(beside(0.4).skin, "Beside the head")) << "a bottle of 30 mm";
}

TEST(JudgeSkin, SaysHowFarTheHeaderSaysThatFatLiesAside) {
    Volume head = mr_of([](const Vector3d& p) { return layered(depth_in_head(p)); });
    const double sigma_mm = judged(head).skin.sigma_mm;
    head.fat_shift_in_ct = {0.1, -1, 0.2};
    const SkinJudgement little = judged(head).skin;
    EXPECT_FALSE(doubts(little, "chemical shift"));
    EXPECT_GT(little.sigma_mm, sigma_mm + 0.2) << "it is in the stated uncertainty";
    head.fat_shift_in_ct *= 2;
    EXPECT_TRUE(doubts(judged(head).skin, "2.0 mm aside, along front and back (chemical shift)"));
}

TEST(JudgeSkin, RefusesABrainWithoutScalp) {
    const Judged brain = judged(mr_of([](const Vector3d& p) { return depth_in_head(p, false) > 13 ? 500.0 : 0.0; }));
    ASSERT_TRUE(brain.refused);
    EXPECT_NE(brain.skin.refusals.front().finding.find("no scalp"), std::string::npos);
    EXPECT_THROW(refuse_implausible(brain.skin), InputError);
}

TEST(JudgeSkin, RefusesABottleAndASmallAnimal) {
    EXPECT_TRUE(judged(mr_of([](const Vector3d& p) {
                    return std::hypot(p.x(), p.y()) < 70 && std::abs(p.z()) < 90 ? 800.0 : 0.0;
                })).refused);
    const Judged small = judged(mr_of([](const Vector3d& p) { return layered(depth_in_head(p * 2.5)); }));
    ASSERT_TRUE(small.refused);
    EXPECT_NE(small.skin.refusals.front().finding.find("no human head"), std::string::npos);
}

TEST(JudgeSkin, SaysThatTheFaceWasTakenAway) {
    const Judged head = judged(
        mr_of([](const Vector3d& p) { return p.z() < 0 && p.y() < -70 ? 0 : layered(depth_in_head(p, false)); }));
    EXPECT_FALSE(head.refused);
    EXPECT_TRUE(std::any_of(head.skin.doubts.begin(), head.skin.doubts.end(), [](const SkinDoubt& d) {
        return d.finding.find("face is not there") != std::string::npos;
    }));
}

TEST(JudgeSkin, SaysWhichSidesAreCutOffWithTheirArea) {
    // The volume ends 60 mm to the left of the middle and 60 mm above it.
    Volume whole = mr_of([](const Vector3d&p) { return layered(depth_in_head(p)); }), part = whole;
    part.size = {56, whole.size[1], 59};
    part.values.clear();
    for (int k = 0; k < part.size[2]; ++k)
        for (int j = 0; j < part.size[1]; ++j)
            for (int i = 0; i < part.size[0]; ++i) part.values.push_back(whole.at(i, j, k));
    const Judged head = judged(part);
    std::map<std::string, double> cm2;
    for (const CutSide& side : head.skin.cut_sides) cm2[side.name] = side.area_cm2;
    const auto ellipse_cm2 = [](double a, double b, double share) {
        return 3.1416 * a * b * (1 - share * share) / 100;
    };
    EXPECT_NEAR(cm2["left side"], ellipse_cm2(92, 85, 61.5 / 75) * 0.85, 30);  // part of it is above the crown's cut
    EXPECT_NEAR(cm2["crown"], ellipse_cm2(75, 92, 60.5 / 85) * 0.9, 25);
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

/// A head with something as bright as scalp where `is_there` says so.
Volume head_with(const std::function<bool(const Vector3d& p, double depth)>& is_there, double turn_degrees = 0) {
    return mr_of(
        [&](const Vector3d& p) {
            const double depth = depth_in_head(p);
            return depth < 0 && is_there(p, depth) ? 900 : layered(depth);
        },
        {125, 145, 115}, 12, turn_degrees);
}

bool phones(const Vector3d& p, double depth) {
    return std::hypot(p.y(), p.z() + 35) < 40 && std::abs(p.x()) > 40 && depth > -32;
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

/// A CT in HU of 3 mm voxels of a head with what lies on it (`on_it`: its HU at a place outside the head, -1000 for
/// nothing).
Volume ct_of(const std::function<double(const Vector3d& p, double depth)>& on_it, const Vector3d& half_mm) {
    Volume ct = mr_of(
        [&](const Vector3d& p) {
            const double depth = depth_in_head(p);
            return 1000 + (depth < 0 ? on_it(p, depth) : depth < 6 ? 40 : depth < 13 ? 900 : 35);
        },
        half_mm);
    ct.modality = "CT";
    ct.is_hu = true;
    for (float& value : ct.values) value -= 1000;
    return ct;
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

/// Cone-beam greys: brain of 210 or -280 "HU". A dry skull's bone, brighter or darker, is never taken for soft tissue.
TEST(JudgeSkin, OfShiftedGreysAHeadIsAHeadAndADrySkullIsNone) {
    const auto stretched = [](Volume ct, float by) {
        for (float& v : ct.values) v = -1000 + by * (v + 1000);
        return ct;
    };
    const auto refused = [](const Volume& ct) {
        try {
            return judged(ct).refused;
        } catch (const InputError&) {  // "no soft tissue"
            return true;
        }
    };
    const Volume head = ct_of([](const Vector3d&, double) { return -1000; }, {105, 125, 115});
    const Volume skull = [&] {
        Volume ct = mr_of(
            [](const Vector3d& p) {
                const double depth = depth_in_head(p);
                return depth < 6 || depth > 13 ? 0.0 : 1500.0;
            },
            {105, 125, 115});
        ct.modality = "CT";
        ct.is_hu = true;
        for (float& value : ct.values) value -= 1000;
        return ct;
    }();
    for (const float by : {0.7F, 1.2F, 1.35F}) {
        const Judged of_head = judged(stretched(head, by));
        EXPECT_FALSE(of_head.refused) << by;
        EXPECT_GT(of_head.skin.layered_share, 0.8) << by;
        EXPECT_TRUE(doubts(of_head.skin, "are not quite HU")) << by;
        EXPECT_EQ(of_head.skin.light_cm2, 0) << by;
        EXPECT_TRUE(refused(stretched(skull, by))) << by;
    }
    EXPECT_FALSE(doubts(judged(head).skin, "are not quite HU"));
    EXPECT_TRUE(refused(skull));
}

TEST(JudgeSkin, AFaceIsThereWhenTheHeadLooksAside) {
    for (const Vector3d& about : {Vector3d(0, 0, -1), Vector3d(0, 0, 1)})
        for (const bool nose : {true, false}) {
            const Eigen::AngleAxisd turn(-35 * std::numbers::pi / 180, about);
            const Judged head =
                judged(mr_of([&](const Vector3d& p) { return layered(depth_in_head(turn * p, nose)); }));
            EXPECT_EQ(doubts(head.skin, "face is not there"), !nose) << about.transpose() << ": " << head.skin.nose_mm;
        }
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

/// A window that begins at 150 makes air (noise of 12) and bone (40) one value. Air that a program blanked is one value
/// as well, but bone is not: nothing was cut off the head.
TEST(JudgeSkin, SaysThatTheDarkEndOfTheGreysWasCutOff) {
    const Volume whole = mr_of([](const Vector3d& p) { return layered(depth_in_head(p)); });
    Volume cut = whole, blanked = whole;
    for (float& value : cut.values) value = std::max(value - 150, 0.0F);
    for (int k = 0; k < whole.size[2]; ++k)
        for (int j = 0; j < whole.size[1]; ++j)
            for (int i = 0; i < whole.size[0]; ++i)
                if (depth_in_head(whole.ct_from_voxel * Vector3d(i, j, k)) < -3)
                    blanked.values[blanked.index(i, j, k)] = 0;
    EXPECT_TRUE(doubts(judged(cut).skin, "dark end of the greys"));
    EXPECT_FALSE(doubts(judged(blanked).skin, "dark end of the greys"));
}

TEST(JudgeSkin, TheSkullsMiddleIsSoughtInWhatTheVolumeShows) {
    // On a turned grid the corners of the skin's box lie beyond the volume's sides.
    const SkinJudgement skin = judged(head_with(phones, 45)).skin;
    EXPECT_LT(skin.ball_centre_in_ct.norm(), 25) << skin.ball_centre_in_ct.transpose();
    EXPECT_GT(skin.layered_share, 0.8);
}

TEST(JudgeSkin, WhereTheVolumeEndsBelowTheCrownTheSidesAreAskedForScalp) {
    Volume part = mr_of([](const Vector3d& p) { return layered(depth_in_head(p)); });
    part.size[2] = 42;  // up to 8 mm above the middle
    part.values.resize(part.index(0, 0, 42));
    const SkinJudgement skin = judged(part).skin;
    EXPECT_GT(skin.layered_share, 0.7);
    EXPECT_FALSE(doubts(skin, "could not be asked"));
    Volume brain = mr_of([](const Vector3d& p) { return depth_in_head(p, false) > 13 ? 500.0 : 0.0; });
    brain.size[2] = 42;
    brain.values.resize(brain.index(0, 0, 42));
    EXPECT_TRUE(judged(brain).refused);
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

TEST(JudgeSkin, ABlurredAverageOfHeadsIsDoubtedAndABlurredBottleRefused) {
    const auto step = [](double d, double wide) { return 1 / (1 + std::exp(-d / wide)); };
    const Judged head = judged(mr_of(
        [&](const Vector3d& p) {
            const double d = depth_in_head(p, false);
            return 350 * step(d, 2.2) - 220 * step(d - 10, 2) + 380 * step(d - 17, 2);
        },
        {105, 125, 115}, 4));
    for (const SkinDoubt& d : head.skin.refusals) ADD_FAILURE() << d.finding << " blur " << head.skin.edge_blur_mm;
    EXPECT_FALSE(head.skin.doubts.empty());
    EXPECT_TRUE(judged(mr_of([&](const Vector3d& p) { return 600 * step(80 - std::hypot(p.x(), p.y(), p.z()), 2.2); },
                             {105, 125, 115}, 4))
                    .refused);
}

TEST(SegmentMrSkin, NoisyDarkBoneAndASpeckOfHolesDoNotOpenTheHead) {
    // Holes of 8 mm through the scalp, noise of a quarter of the brain.
    const Volume volume = mr_of(
        [](const Vector3d& p) {
            const bool hole = std::hypot(p.x() - 30, p.y() - 20) < 4 && p.z() > 0;
            const double depth = depth_in_head(p);
            return hole && depth < 13 ? 40.0 * (depth > 0) : layered(depth);
        },
        {105, 125, 115}, 60);
    const SkinMask mask = segment_skin(volume);
    EXPECT_NEAR(mask.volume_ml, 4.0 / 3 * 3.1416 * 7.5 * 9.2 * 8.5, 100);
}

}  // namespace
}  // namespace planlight::test
