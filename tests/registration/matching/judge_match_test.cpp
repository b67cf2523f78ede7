#include "registration/matching/judge_match.h"

#include <gtest/gtest.h>

namespace planlight {
namespace {

Verdict verdict_of(double shape_rms_mm, double weakest_sigma_mm, bool skin_found = true, double movement_mm = 0,
                   bool shape_tried = true) {
    FineMatch fine;
    fine.fit.shape_rms_mm = shape_rms_mm;
    fine.weakest.sigma_mm = weakest_sigma_mm;
    RegistrationResult result;
    result.mirror_ratio = 2;
    result.skin_movement_mm = movement_mm;
    if (shape_tried) result.shape_change_mm = 0;
    if (skin_found) result.skin.places.resize(1);
    Judgement judgement(result);
    judge_fine_match({}, fine, result, judgement);
    return result.verdict;
}

// A sheet that followed a head 14 mm over it lay within 0.57 mm (rms) of the skin 14 mm beside its place, where it
// could slide by 0.87 mm: neither is much, both together are.
TEST(JudgeMatch, AnotherShapeAtAPlaceThatCouldSlideIsAskedAbout) {
    EXPECT_EQ(verdict_of(0.57, 0.87), Verdict::ask);
    EXPECT_EQ(verdict_of(0.57, 0.3), Verdict::yes) << "well determined";
    EXPECT_EQ(verdict_of(0.3, 0.87), Verdict::yes) << "the skin as it is in the CT";
    EXPECT_EQ(verdict_of(0.1, 1.3), Verdict::ask) << "could slide too far whatever its shape";
}

TEST(JudgeMatch, WhereTheSkinWasFoundNowhereLightMayFallAside) {
    EXPECT_EQ(verdict_of(0.1, 0.1), Verdict::yes);
    EXPECT_EQ(verdict_of(0.1, 0.1, false), Verdict::ask);
}

TEST(JudgeMatch, AShapeThatWasNotLookedAtIsNoRightShape) {
    EXPECT_EQ(verdict_of(0.1, 0.1, true, 0, false), Verdict::ask);
}

// Neither "by inf mm" nor one reason told thrice: three are a refusal where skin was found among cloth.
TEST(JudgeMatch, APoseOfWhichNothingIsKnownIsAskedAboutInOneSentence) {
    FineMatch fine;
    fine.weakest = weakest_way(PoseCovariance());
    RegistrationResult result;
    result.mirror_ratio = 2;
    Judgement judgement(result);
    judge_fine_match({}, fine, result, judgement);
    EXPECT_EQ(result.verdict, Verdict::ask);
    ASSERT_EQ(result.reasons.size(), 1U);
    EXPECT_EQ(result.reasons[0].find("inf"), std::string::npos) << result.reasons[0];
    EXPECT_NE(result.reasons[0].find("too few points"), std::string::npos) << result.reasons[0];
}

// Broad swellings of one side, 2.5 to 5 mm high, were taken for pose in part: up to 2.2 mm off, 0.62 to 0.77 mm found.
TEST(JudgeMatch, SkinThatMovedMuchIsAskedAbout) {
    EXPECT_EQ(verdict_of(0.1, 0.1, true, 0.3), Verdict::yes);
    EXPECT_EQ(verdict_of(0.1, 0.1, true, 0.62), Verdict::ask);
}

}  // namespace
}  // namespace planlight
