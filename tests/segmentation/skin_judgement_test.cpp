#include "segmentation/skin_judgement.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "planning_io/types/error.h"
#include "tests/segmentation/analytic_heads.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

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

/// A CT as pictures show it: -160 to 30 HU in 256 greys. Bone and brain are one grey and show no layers.
TEST(JudgeSkin, ARefusedCtOfAWindowForPicturesIsCalledThat) {
    Volume pictures = ct_of([](const Vector3d&, double) { return -1000; }, {105, 125, 115});
    for (float& value : pictures.values) value = std::round(std::clamp((value + 160) / 190 * 255, 0.0F, 255.0F));
    pictures.is_hu = false;
    pictures.modality.clear();
    const Judged head = judged(pictures);
    ASSERT_TRUE(head.refused);
    const std::string& finding = head.skin.refusals.front().finding;
    EXPECT_NE(finding.find("show exactly the greatest value"), std::string::npos) << finding;
    EXPECT_EQ(finding.find("stripped brain"), std::string::npos) << finding;
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
