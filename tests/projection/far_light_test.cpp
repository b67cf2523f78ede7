// Light that lies farther aside than each stroke is looked for, and small figures that are looked for whole, as cameras
// see them that share no code with what looks (`lit_ball`).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "projection/check_light.h"
#include "projection/render_drawing.h"
#include "tests/projection/lit_ball.h"
#include "tests/projection/shapes.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double kPxPerMm = 2450.0 / 700;  // of the projector, on the skin that it looks at

Borehole hole(double longitude_mm, double latitude_mm, double diameter_mm) {
    const Vector3d at = test::on_ball(0.3 + longitude_mm / (test::kBallRadius_mm * std::cos(0.4)),
                                      0.4 + latitude_mm / test::kBallRadius_mm);
    return {"S", at, Vector3d(-at.normalized()), diameter_mm, 8, {}};
}

/// Screws of a plate: too small, and too near each other, for strokes of their own or marks.
Plan plate(double diameter_mm) {
    Plan plan;
    for (int i = 0; i < 6; ++i) plan.boreholes.push_back(hole(7.0 * (i % 3) - 7, 7.0 * (i / 3), diameter_mm));
    return plan;
}

Plan outline() {
    Plan plan;
    plan.boreholes = {hole(-20, -12, 12), hole(22, 8, 9)};
    plan.osteotomy_lines.push_back(
        {"Cut",
         {hole(-18, 14, 1).position_in_ct, hole(5, 18, 1).position_in_ct, hole(20, -15, 1).position_in_ct},
         false,
         {}});
    return plan;
}

PlanDrawing drawing_of(const Plan& plan) {
    DrawingSettings settings;
    settings.check_marks = false;
    return draw_plan(plan, test::ball(), settings);
}

LightCheck look(const PlanDrawing& drawing, const test::LitBall& lit) {
    const RigCalibration rig = test::rig_before_ball();
    return check_light(drawing, test::ball(), rig, RigidTransform::Identity(), test::pictures_of(drawing, rig, lit));
}

TEST(SmallFigures, AreToldEachInBothDirections) {
    for (const double diameter_mm : {0.0, 1.5, 2.4, 4.0}) {
        const PlanDrawing drawing = drawing_of(plate(diameter_mm));
        for (const Vector2d& moved_mm : {Vector2d(0, 0), Vector2d(0.5, -0.3), Vector2d(-1.1, 0.9)}) {
            test::LitBall lit;
            lit.picture_moved_px = kPxPerMm * moved_mm;
            const LightCheck check = look(drawing, lit);
            ASSERT_EQ(check.items.size(), 6U);
            EXPECT_TRUE(check.told_whole) << diameter_mm;
            for (const ItemLight& item : check.items) {
                EXPECT_EQ(item.seen, item.segments) << diameter_mm;
                EXPECT_GT(item.seen, 0) << diameter_mm;
                EXPECT_FALSE(item.one_direction_only);
                EXPECT_NEAR(item.off_mm, moved_mm.norm(), 0.15) << diameter_mm << " moved " << moved_mm.transpose();
                EXPECT_LT(item.sigma_mm, 0.25);
            }
        }
    }
}

// At the edge of the projector's picture: of a hole that is lit by half the gate must know.
TEST(SmallFigures, OneThatIsLitInPartCountsAsLit) {
    const PlanDrawing drawing = drawing_of(plate(2.4));
    RigCalibration rig = test::rig_before_ball();
    const int whole = rig.projector.width;
    const double middle = project(rig.projector, hole(0, 7, 1).position_in_ct)->x();
    int in_part = 0;
    for (int cut = -6; cut <= 6; ++cut) {
        rig.projector.width = std::min(whole, static_cast<int>(middle) + cut);
        RgbImage picture;
        const RenderCounts counts =
            DrawingRenderer(test::ball(), rig.projector).render_into(picture, drawing, RigidTransform::Identity());
        LightCheck check =
            check_light(drawing, test::ball(), rig, RigidTransform::Identity(), test::pictures_of(drawing, rig, {}));
        note_lit_items(counts, check);
        for (std::size_t i = 0; i < check.items.size(); ++i) {
            in_part += counts.items[i].lit_share() > 0.2 && counts.items[i].lit_share() < 0.8;
            if (counts.items[i].lit_share() > 0.2) {
                EXPECT_TRUE(check.items[i].lit) << i << " cut at " << cut;
            }
        }
    }
    EXPECT_GT(in_part, 3);
}

TEST(SmallFigures, OneThatIsCoveredIsNotSeenThoughItsNeighboursAre) {
    const Plan plan = plate(2.4);
    test::LitBall lit;
    lit.covered = plan.boreholes[4].position_in_ct;
    const LightCheck check = look(drawing_of(plan), lit);
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(check.items[i].seen > 0, i != 4)
            << i << ": " << check.items[i].seen << " of " << check.items[i].segments;
}

TEST(SmallFigures, AreNotSeenWithoutLightWhateverTheSkinLooksLike) {
    for (const double texture : {0.0, 15.0, 40.0}) {
        test::LitBall dark;
        dark.lit = false;
        dark.texture_grey = texture;
        const LightCheck check = look(drawing_of(plate(2.4)), dark);
        EXPECT_LE(check.seen, 2) << texture << ": " << check.seen << " of " << check.expected;
        EXPECT_FALSE(check.far_mm) << texture;
    }
}

TEST(FarLight, IsFoundInAllDirectionsMostlyAlsoOfAPatternThatComesBack) {
    for (const auto& [name, plan] :
         {std::pair("outline", outline()), {"plate", plate(2.4)}, {"plate of points", plate(0)}}) {
        int found = 0;
        for (const double mm : {3.5, 5.5, 11.0})
            for (int k = 0; k < 3; ++k) {
                const double angle = 0.3 + k * 2 * std::numbers::pi / 3;
                test::LitBall lit;
                lit.picture_moved_px = kPxPerMm * mm * Vector2d(std::cos(angle), std::sin(angle));
                lit.texture_grey = 15;
                const LightCheck check = look(drawing_of(plan), lit);
                if (!check.far_mm && check.most_mm > 2) {  // told by the strokes themselves
                    ++found;
                    continue;
                }
                if (!check.far_mm) {
                    std::printf("%s, %.1f mm at %.1f: not found; %d of %d near its place\n", name, mm, angle,
                                check.seen, check.expected);
                    continue;
                }
                ++found;
                EXPECT_GT(*check.far_mm, 2) << name;  // a pattern that comes back every 7 mm may tell less
            }
        EXPECT_GE(found, name == std::string("outline") ? 9 : 5) << "of 9: " << name;
    }
}

TEST(FarLight, IsNotFoundWhereThereIsNoneOrWhereItBelongs) {
    for (const double texture : {0.0, 15.0, 40.0})
        for (const bool lit_at_all : {false, true}) {
            test::LitBall lit;
            lit.lit = lit_at_all;
            lit.texture_grey = texture;
            EXPECT_FALSE(look(drawing_of(outline()), lit).far_mm) << texture << " " << lit_at_all;
        }
}

/// On a hand before the skin the light seems to lie elsewhere to each camera: it is covered, not wrong.
TEST(FarLight, OnAHandBeforeTheSkinIsNoLightAsideTheSkin) {
    for (const double before_mm : {20.0, 30.0}) {
        test::LitBall hand;
        hand.plate_mm = before_mm;
        EXPECT_FALSE(look(drawing_of(outline()), hand).far_mm) << before_mm;
    }
}

}  // namespace
}  // namespace planlight
