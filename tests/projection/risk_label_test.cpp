#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "projection/draw_plan.h"
#include "projection/label_names.h"
#include "projection/lay_out_label.h"
#include "projection/place_all_labels.h"
#include "tests/projection/shapes.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using test::ball;
using test::on_ball;

/// A ball of 3 mm so far under the skin from the end of a hole of 6 mm there.
RiskStructure under(const Vector3d& at, double room_mm, const std::string& name) {
    constexpr double kRadius_mm = 3, kDepth_mm = 6;
    RiskStructure made{name, test::ball_mesh(kRadius_mm, 4)};
    for (auto& p : made.surface.vertices_in_ct) p += at * (1 - (kDepth_mm + room_mm + kRadius_mm) / at.norm());
    return made;
}

Plan plan_with(double room_mm, const std::string& structure) {
    Plan plan;
    const Vector3d at = on_ball(0.1, 0.1);
    plan.boreholes.push_back({"B1", at, Vector3d(-at.normalized()), 7, 6, {}});
    plan.risk_structures = {under(at, room_mm, structure)};
    return plan;
}

std::string words_of(const PlanDrawing& drawing) {
    for (const Label& label : drawing.labels)
        if (!label.of_moment) return label.words;
    return {};
}

TEST(RiskLabel, TheNearestStructureIsAWholeLineOfTheLabel) {
    EXPECT_EQ(words_of(draw_plan(plan_with(4.15, "Nerve"), ball())), "B1\n7 mm wide\n6 mm deep\n4.1 mm to\nNerve");
    EXPECT_EQ(words_of(draw_plan(plan_with(-2, "VII"), ball())), "B1\n7 mm wide\n6 mm deep\nthrough VII");
}

TEST(RiskLabel, WhatIsMoreThanTenMillimetresAwayIsNotSaid) {
    const PlanDrawing near = draw_plan(plan_with(9.95, "Nerve"), ball()),
                      far = draw_plan(plan_with(10.15, "Nerve"), ball());
    EXPECT_EQ(words_of(near), "B1\n7 mm wide\n6 mm deep\n9.9 mm to\nNerve");
    EXPECT_EQ(words_of(far), "B1\n7 mm wide\n6 mm deep");
    EXPECT_EQ(far.items[0].clearances.size(), 1U) << "window and pages say it";
}

TEST(RiskLabel, ALongNameStandsBelowItsFigureWhichIsNeverCut) {
    EXPECT_EQ(words_of(draw_plan(plan_with(4.15, "Facial nerve"), ball())),
              "B1\n7 mm wide\n6 mm deep\n4.1 mm to\nFacial nerve");
    const TextBlock block = lay_out({"T", {}, RiskText{"4.1 mm to", "Arteriacarotisinternasinistra", {}, false}}, 5);
    EXPECT_EQ(block.words.substr(0, 12), "T\n4.1 mm to\n");
    EXPECT_NE(block.words.find("…"), std::string::npos) << block.words;
    EXPECT_LE(block.width_mm, kMaxLine_mm + 0.5);
}

TEST(RiskLabel, OthersThatWarnAreCounted) {
    Plan plan = plan_with(-2, "Dura");
    const Vector3d at = plan.boreholes[0].position_in_ct;
    plan.risk_structures.push_back(under(at, 1.5, "Sinus"));
    plan.risk_structures.push_back(under(at, 5, "Nerve"));
    EXPECT_EQ(words_of(draw_plan(plan, ball())), "B1\n7 mm wide\n6 mm deep\nthrough\nDura\nand 1 more");
}

TEST(RiskLabel, WhatIsCutIsLabelledWhereItWarnsOnly) {
    Plan plan;
    plan.osteotomy_lines.push_back({"O", {on_ball(-0.3, 0), on_ball(0.3, 0)}, false, {}});
    int warned = 0;
    for (double room_mm = -5; room_mm < 0; room_mm += 0.4) {
        plan.risk_structures = {under(on_ball(0, 0), room_mm, "Nerve")};
        const PlanDrawing drawing = draw_plan(plan, ball());
        const bool warning = warns(drawing.items[0].clearances.at(0));
        warned += warning;
        EXPECT_EQ(words_of(drawing).find("Nerve") != std::string::npos, warning) << words_of(drawing);
    }
    EXPECT_GT(warned, 0);
    EXPECT_LT(warned, 13);
}

/// Markers all over the skin but within so far of a place.
std::vector<Vector3d> markers_round(const Vector3d& at, double free_mm) {
    constexpr int kMarkers = 300;
    std::vector<Vector3d> markers;
    for (int i = 0; i < kMarkers; ++i) {  // evenly over the ball, along a spiral
        const double z = 1 - (2 * i + 1.0) / kMarkers, around = i * M_PI * (3 - std::sqrt(5.0)),
                     across = std::sqrt(1 - z * z);
        const Vector3d p = test::kBallRadius_mm * Vector3d(across * std::cos(around), across * std::sin(around), z);
        if ((p - at).norm() > free_mm + 11) markers.push_back(p);
    }
    return markers;
}

// The less skin is free: what warns stays longer than the hole's own figures; what does not goes before them.
TEST(RiskLabel, AWarningIsGivenUpAfterTheFiguresAndOtherDistancesBeforeThem) {
    for (const auto& [room_mm, figure] : {std::pair{0.55, "0.5 mm to"}, std::pair{4.15, "4.1 mm to"}}) {
        const bool warning = room_mm < kNearRisk_mm;
        const Plan plan = plan_with(room_mm, "Nerve");
        std::map<std::pair<bool, bool>, int> seen;  // whether it has the risk, the figures
        for (double free_mm = 60; free_mm > 20; free_mm -= 2) {
            DrawingSettings settings;
            settings.keep_clear_in_ct = markers_round(plan.boreholes[0].position_in_ct, free_mm);
            const PlanDrawing drawing = draw_plan(plan, ball(), settings);
            const std::string words = words_of(drawing);
            const bool risk = words.find(figure) != std::string::npos, wide = words.find("wide") != std::string::npos;
            ++seen[{risk, wide}];
            EXPECT_EQ(drawing.items[0].unlit_warning, warning && !risk ? "0.5 mm to Nerve" : "") << words;
        }
        EXPECT_GT((seen[{true, true}]), 0) << figure;
        EXPECT_EQ((seen[{true, false}]) > 0, warning) << figure;
        EXPECT_EQ((seen[{false, true}]) > 0, !warning) << figure;
    }
}

TEST(RiskLabel, AWarningIsNotGivenUpForTheShareOfText) {
    for (const bool warning : {true, false}) {
        DrawingSettings settings;
        settings.most_text = 0.1;
        const std::string words = words_of(draw_plan(plan_with(warning ? 0.55 : 4.15, "Nerve"), ball(), settings));
        EXPECT_EQ(words, warning ? "B1\n0.5 mm to\nNerve" : "");
    }
}

TEST(RiskLabel, NamesThatLookTheSameOrCannotBeLitAreNumbers) {
    Plan plan;
    const auto long_name = [](char middle) { return "Nerve of the " + std::string(80, middle) + " deep branch"; };
    for (const auto& name :
         {long_name('a'), long_name('b'), std::string("Dura"), std::string("\xF3\xB0\x80\x80"), long_name('a')})
        plan.risk_structures.push_back({name, {}});
    const auto lit = lit_structures(plan, 5);
    EXPECT_EQ(lit[0].name, "structure 1");
    EXPECT_EQ(lit[1].name, "structure 2");
    EXPECT_EQ(lit[2].name, "Dura");
    EXPECT_EQ(lit[3].name, "structure 4");
    EXPECT_EQ(lit[4].name, "structure 1") << "of the same name: no reader could tell them apart, nor is one misnamed";
    EXPECT_EQ(lit[2].warning, "");
    EXPECT_NE(lit[3].warning.find("structure 4"), std::string::npos);
}

// The skin as it is now has moved: what was planned has not.
TEST(RiskLabel, DistancesAreThoseOfThePlanWhateverTheSkinDoes) {
    const Plan plan = plan_with(4.15, "Nerve");
    const SkinSurface now(test::ball_mesh(test::kBallRadius_mm + 2, 5));
    const PlanDrawing drawing = draw_plan(plan, ball(), now);
    ASSERT_EQ(drawing.items[0].clearances.size(), 1U);
    EXPECT_NEAR(drawing.items[0].clearances[0].mm, 4.15, 2e-3);
    const PlanDrawing again = draw_plan(plan, ball(), now, {}, clearances_in(drawing));
    EXPECT_EQ(again.items[0].clearances, drawing.items[0].clearances);
}

}  // namespace
}  // namespace planlight
