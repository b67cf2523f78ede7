#include "projection/check_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "planning_io/types/error.h"
#include "projection/draw_plan.h"
#include "projection/mid_plane.h"
#include "projection/plan_sides.h"
#include "tests/projection/shapes.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using test::ball;
using test::on_ball;
constexpr double kRadius_mm = test::kBallRadius_mm;

bool said(const std::vector<std::string>& sentences, const std::string& text) {
    return std::any_of(sentences.begin(), sentences.end(),
                       [&](const auto& f) { return f.find(text) != std::string::npos; });
}

/// A plan of good items, of which one is spoilt.
Plan good_plan() {
    Plan plan;
    plan.trajectories.push_back({"T1", on_ball(0, 0), on_ball(0, 0) * 0.5, 2, {}});
    plan.boreholes.push_back({"B1", on_ball(0.5, 0.2), {}, 7, 6, {}});
    plan.osteotomy_lines.push_back({"O1", {on_ball(0, 0.5), on_ball(0.3, 0.5), on_ball(0.3, 0.8)}, true, {}});
    return plan;
}

TEST(CheckPlan, AGoodPlanHasNeitherWarningsNorStops) {
    const PlanVerdict verdict = check_plan(good_plan(), ball());
    EXPECT_TRUE(verdict.warnings.empty());
    EXPECT_TRUE(verdict.stops.empty());
    EXPECT_LT(verdict.median_to_skin_mm, 0.1);
    EXPECT_NO_THROW(refuse_stopped_plan(verdict));
}

TEST(CheckPlan, OneItemALittleOffIsWarnedOfWithItsNumber) {
    Plan plan = good_plan();
    plan.trajectories[0].entry_in_ct = on_ball(0, 0) * (94 / kRadius_mm);
    plan.cut_planes.push_back({"C1", {0, 0, 200}, Vector3d::UnitZ(), Vector3d::UnitX(), 50, 50, {}});
    plan.osteotomy_lines.push_back({"O2", {on_ball(0, 0)}, false, {}});
    const PlanVerdict verdict = check_plan(plan, ball());
    EXPECT_TRUE(verdict.stops.empty()) << verdict.stops.front();
    EXPECT_TRUE(said(verdict.warnings, "T1: its entry is 14.0 mm from the skin"));
    EXPECT_TRUE(said(verdict.warnings, "C1: it does not meet the skin"));
    EXPECT_TRUE(said(verdict.warnings, "O2: it has 1 point(s)"));
}

// Points in a wrong order make a web of a craniotomy; in their order, or as a figure that only bends, they do not.
TEST(CheckPlan, ALineThatCrossesItselfIsWarnedOf) {
    const auto ring = [](const std::vector<int>& order) {
        Plan plan = good_plan();
        OsteotomyLine line{"O2", {}, true, {}};
        for (const int i : order) {
            const double angle = i * 2 * 3.14159265358979 / static_cast<double>(order.size());
            line.points_in_ct.push_back(on_ball(0.3 + 0.35 * std::cos(angle), 0.35 * std::sin(angle)));
        }
        plan.osteotomy_lines.push_back(line);
        return check_plan(plan, ball());
    };
    EXPECT_FALSE(said(ring({0, 1, 2, 3, 4, 5, 6, 7}).warnings, "crosses itself"));
    EXPECT_TRUE(said(ring({0, 1, 3, 2, 4, 5, 6, 7}).warnings,
                     "O2: it crosses itself: its way from point 2 to 3 and that from 4 to 5 meet"));
    EXPECT_TRUE(said(ring({0, 4, 2, 6, 1, 5, 3, 7}).warnings, "crosses itself"));
    Plan eight = good_plan();
    eight.osteotomy_lines.push_back(
        {"O3", {on_ball(0, 0), on_ball(0.6, 0.6), on_ball(0.6, 0), on_ball(0, 0.6)}, false, {}});
    EXPECT_TRUE(said(check_plan(eight, ball()).warnings, "O3: it crosses itself"));
    eight.osteotomy_lines.back().points_in_ct = {on_ball(0, 0), on_ball(0, 0.6), on_ball(0.6, 0.6), on_ball(0.6, 0)};
    EXPECT_FALSE(said(check_plan(eight, ball()).warnings, "crosses itself"));
}

// Most of the plan on the skin and one hole well under it: a dressing lies there, or the hole was planned on bone.
TEST(CheckPlan, AnItemUnderWhatLiesOnTheSkinIsWarnedOf) {
    Plan plan = good_plan();
    plan.boreholes[0].position_in_ct *= (kRadius_mm - 7) / kRadius_mm;
    EXPECT_TRUE(said(check_plan(plan, ball()).warnings, "B1: it lies 7.0 mm under the skin, most of the plan"));
    EXPECT_FALSE(said(check_plan(plan, ball(), {}, plan_checks_on(true)).warnings, "under the skin, most"));
    for (auto& p : plan.osteotomy_lines[0].points_in_ct) p *= (kRadius_mm - 7) / kRadius_mm;  // on bone as well
    EXPECT_FALSE(said(check_plan(plan, ball()).warnings, "under the skin, most"));
}

TEST(CheckPlan, WhatMustNotBeShownIsStoppedByNameAndNumber) {
    const auto stops_of = [](const std::function<void(Plan&)>& spoil) {
        Plan plan = good_plan();
        spoil(plan);
        const PlanVerdict verdict = check_plan(plan, ball());
        EXPECT_THROW(refuse_stopped_plan(verdict), InputError);
        return verdict.stops;
    };
    EXPECT_TRUE(said(stops_of([](Plan& p) { p.boreholes[0].position_in_ct.x() = std::nan(""); }),
                     "B1: its numbers are not finite"));
    EXPECT_TRUE(said(
        stops_of([](Plan& p) { p.osteotomy_lines[0].points_in_ct[1].z() = std::numeric_limits<double>::infinity(); }),
        "O1: its numbers are not finite"));
    EXPECT_TRUE(said(stops_of([](Plan& p) { p.trajectories[0].target_in_ct = on_ball(0, 0) * 1.5; }),
                     "T1: its target lies outside the body, 40.0 mm"));
    EXPECT_TRUE(
        said(stops_of([](Plan& p) { std::swap(p.trajectories[0].entry_in_ct, p.trajectories[0].target_in_ct); }),
             "T1: entry and target are swapped: the entry lies 40.0 mm under the skin"));
    EXPECT_TRUE(said(stops_of([](Plan& p) { p.trajectories[0].target_in_ct = on_ball(0, 0) * 0.995; }),
                     "T1: entry and target are only 0.40 mm apart"));
    EXPECT_TRUE(said(stops_of([](Plan& p) { p.boreholes[0].depth_mm = 250; }), "B1: it is 250 mm deep"));
    EXPECT_TRUE(said(stops_of([](Plan& p) { p.boreholes[0].axis_in_ct = on_ball(0.5, 0.2).normalized(); }),
                     "B1: its axis points out of the body"));
    EXPECT_TRUE(
        said(stops_of([](Plan& p) { p.boreholes[0].position_in_ct *= 1.5; }), "B1: it is 40.0 mm from the skin"));
    EXPECT_TRUE(said(stops_of([](Plan& p) {
                         p.boreholes[0].position_in_ct *= 1.2;
                         p.trajectories[0].entry_in_ct *= 1.2;
                     }),
                     "2 of 3 items lie more than 10 mm from the skin"));
}

/// As of a scan whose patient lay elsewhere, or one whose skin has lost a layer: each item alone might be meant.
TEST(CheckPlan, APlanInTheAirIsStoppedAndOneOnTheBoneIsNot) {
    const auto verdict_at = [](double over_mm, bool trajectories_alone = false, bool on_given_surface = false) {
        Plan plan = good_plan();
        const double scale = (kRadius_mm + over_mm) / kRadius_mm;
        plan.trajectories.push_back({"T2", on_ball(0.4, 0), on_ball(0.4, 0) * 0.5, 2, {}});
        plan.trajectories.push_back({"T3", on_ball(0, 0.4), on_ball(0, 0.4) * 0.5, 2, {}});
        for (Trajectory& t : plan.trajectories) t.entry_in_ct *= scale;
        for (Borehole& b : plan.boreholes) b.position_in_ct *= scale;
        for (Vector3d& p : plan.osteotomy_lines[0].points_in_ct) p *= scale;
        if (trajectories_alone) plan.boreholes.clear(), plan.osteotomy_lines.clear();
        return check_plan(plan, ball(), std::nullopt, plan_checks_on(on_given_surface));
    };
    const PlanVerdict over_bone = verdict_at(7.5, false, true);
    EXPECT_TRUE(over_bone.stops.empty()) << "a plan for the skin, shown on bone";
    EXPECT_FALSE(said(over_bone.warnings, "in the air"));
    EXPECT_TRUE(
        said(verdict_at(7.5).stops, "the plan's lines and boreholes lie in the air, a median of 7.5 mm over the skin"));
    const PlanVerdict near = verdict_at(3.5);
    EXPECT_TRUE(near.stops.empty()) << near.stops.front();
    EXPECT_TRUE(said(near.warnings, "lie in the air, a median of 3.5 mm over the skin"));
    const PlanVerdict entries = verdict_at(7.5, true);
    EXPECT_TRUE(entries.stops.empty()) << "programs set entries before the skin, and their axes are right";
    EXPECT_TRUE(said(entries.warnings, "the plan's entries lie in the air, a median of 7.5 mm over the skin"));
    for (const double under_mm : {0.0, -1.0, -7.5}) {
        const PlanVerdict verdict = verdict_at(under_mm);
        EXPECT_TRUE(verdict.stops.empty()) << under_mm;
        EXPECT_FALSE(said(verdict.warnings, "in the air")) << under_mm;
    }
}

TEST(CheckPlan, WhatLiesOutsideTheVolumeIsStopped) {
    VolumeBox box;
    box.ct_from_voxel.translation() = Vector3d(-90, -90, -90);
    box.size = {181, 181, 181};
    EXPECT_TRUE(check_plan(good_plan(), ball(), box).stops.empty());
    box.size = {181, 181, 140};  // up to z = 49: O1 reaches up to 57.4
    EXPECT_TRUE(
        said(check_plan(good_plan(), ball(), box).stops, "O1: its point (53, 16, 57) lies 8 mm outside the volume"));
    EXPECT_TRUE(check_plan(good_plan(), ball(), box).outside_volume);
}

// 3 mm over the ball along its tangent; 8 mm under flat skin at 84 degrees it is 77 mm to the skin.
TEST(CheckPlan, AnAxisThatDoesNotMeetTheSkinIsStopped) {
    const auto verdict_of = [](double over_mm) {
        Plan plan = good_plan();
        plan.boreholes.push_back({"B2", {kRadius_mm + over_mm, 0, 0}, Vector3d::UnitZ(), 7, 5, {}});
        return check_plan(plan, ball());
    };
    EXPECT_TRUE(said(verdict_of(3).stops,
                     "B2: its axis does not meet the skin within 60 mm of its position; the nearest place on the skin "
                     "lies 3.0 mm beside the axis"));
    EXPECT_TRUE(verdict_of(1).stops.empty());
    EXPECT_TRUE(said(verdict_of(1).warnings,
                     "B2: its axis does not meet the skin within 60 mm of its position; it is "
                     "drawn 1.0 mm beside the axis"));
    Plan steep;
    const double theta = 84 * M_PI / 180;
    const Vector3d entry(0, 0, -8), inwards(std::sin(theta), 0, -std::cos(theta));
    steep.trajectories.push_back({"T2", entry, entry + 60 * inwards, 2, {}});
    EXPECT_TRUE(
        said(check_plan(steep, SkinSurface(test::sheet_mesh(200, 4))).stops,
             "T2: its axis does not meet the skin within 60 mm of its entry; the nearest place on the skin lies "
             "8.0 mm beside the axis"));
}

/// A head of 90 mm of which the scan holds what lies under z = 50.
TEST(CheckPlan, WhatComesToLieOnTheEndOfTheVolumeIsStopped) {
    const SkinSurface cut(test::cut_ball_mesh(90, 50));
    const double rim_mm = std::sqrt(90 * 90 - 50 * 50);
    const auto on_skin = [](double longitude, double z) {
        const double r = std::sqrt(90 * 90 - z * z);
        return Vector3d(r * std::cos(longitude), r * std::sin(longitude), z);
    };
    Plan good;
    good.trajectories.push_back({"SEEG 1", on_skin(0, 30), {10, 5, -20}, 2, {}});
    good.boreholes.push_back({"B", on_skin(1, 20), {}, 14, 5, {}});
    good.osteotomy_lines.push_back({"O", {on_skin(2, 10), on_skin(2.5, 30)}, false, {}});
    EXPECT_TRUE(check_plan(good, cut).stops.empty()) << check_plan(good, cut).stops.front();
    EXPECT_TRUE(check_plan(good, cut).warnings.empty()) << check_plan(good, cut).warnings.front();

    Plan wrong = good;
    wrong.trajectories[0].entry_in_ct = {20, 10, 48};
    wrong.boreholes[0].position_in_ct = {rim_mm - 5, 0, 50};
    wrong.osteotomy_lines[0].points_in_ct[1] = {0, 30, 47};
    const auto stops = check_plan(wrong, cut).stops;
    for (const char* words :
         {"SEEG 1: its entry comes to lie on the end of the volume, where the scan ends and shows no skin",
          "B: its position comes to lie on the end", "O: a point of it comes to lie on the end"})
        EXPECT_TRUE(said(stops, words)) << words;
    EXPECT_TRUE(draw_plan(wrong, cut).strokes.empty());

    // Its own place is skin, and what is drawn about it is not.
    Plan partly;
    partly.boreholes.push_back({"At the rim", on_skin(0, 47), {}, 14, 5, {}});
    partly.osteotomy_lines.push_back({"Across", {on_skin(0, 45), on_skin(2.8, 45)}, false, {}});
    const PlanVerdict verdict = check_plan(partly, cut);
    EXPECT_TRUE(verdict.stops.empty()) << verdict.stops.front();
    EXPECT_TRUE(said(verdict.warnings, "At the rim: 3")) << "a third of its ring";
    EXPECT_TRUE(said(verdict.warnings, "% of its ring lies on the end of the volume"));
    EXPECT_TRUE(said(verdict.warnings, "mm of it run over the end of the volume"));

    // A lid over the mouth, a nostril or an ear is closed by hand, and no reason to stop.
    const PlanVerdict lid = check_plan(wrong, SkinSurface(test::cut_ball_mesh(90, 50, kSeal)));
    EXPECT_TRUE(lid.stops.empty()) << lid.stops.front();
    EXPECT_TRUE(said(lid.warnings, "SEEG 1: its entry comes to lie on a lid over an opening"));
}

TEST(CheckPlan, WhatTheSkinHasNoRoomForIsSaid) {
    const auto hole = [](const Vector3d& at, double diameter_mm) {
        Plan plan;
        plan.boreholes.push_back({"B", at, {}, diameter_mm, 5, {}});
        return plan;
    };
    const auto line = [](const Vector3d& a, const Vector3d& b) {
        Plan plan;
        plan.osteotomy_lines.push_back({"O", {a, b}, false, {}});
        return plan;
    };
    const SkinSurface sheet(test::sheet_mesh(200, 4));  // its border at 100 mm
    EXPECT_TRUE(check_plan(hole({90, 0, 0}, 14), sheet).warnings.empty());
    EXPECT_TRUE(said(check_plan(hole({97, 0, 0}, 14), sheet).warnings, "% of its ring lies beyond the border"));
    EXPECT_TRUE(said(check_plan(hole({101, 0, 1}, 14), sheet).warnings,
                     "B: its position lies 1.0 mm beyond the border of the surface; it is drawn at the border"));
    EXPECT_TRUE(said(check_plan(hole({105, 0, 1}, 14), sheet).stops,
                     "B: its position lies 5.0 mm beyond the border of the surface"));
    EXPECT_TRUE(said(check_plan(line({80, 0, 0}, {105, 0, 1}), sheet).stops,
                     "O: a point of it lies 5.0 mm beyond the border of the surface"));

    // A finger is no place for a large drill: round it the ring is 20 mm, straight across 2 * 5 * sin(2).
    const SkinSurface finger(test::tube_mesh(5, 100, 1)), arm(test::tube_mesh(20, 200, 2));
    EXPECT_TRUE(said(check_plan(hole({5, 0, 0}, 20), finger).warnings,
                     "B: the skin bends so much under its ring of 20.0 mm along the skin that this is only 9.1 mm"));
    EXPECT_TRUE(check_plan(hole({20, 0, 0}, 20), arm).warnings.empty());

    // The border of the first is ragged, its next corner at (51.2, 2). That of the other is straight, at 70: 18.8 mm
    // across.
    const SkinSurface apart(test::both(test::sheet_mesh(100, 4), test::sheet_mesh(100, 4), {120, 0, 0}));
    const auto jumps = check_plan(line({40, 0, 0}, {80, 0, 0}), apart).warnings;
    EXPECT_TRUE(said(jumps, "O: it jumps 18.8 mm where the skin has a fold")) << testing::PrintToString(jumps);
    EXPECT_TRUE(check_plan(line({-40, 0, 0}, {40, 0, 0}), apart).warnings.empty());
    const auto on_arm = [](double angle) { return Vector3d(20 * std::cos(angle), 20 * std::sin(angle), 0); };
    EXPECT_TRUE(said(check_plan(line(on_arm(0), on_arm(2.97)), arm).warnings,
                     "O: from its point 1 to 2 it runs 59 mm over the skin, though they are 40 mm apart"));
    EXPECT_TRUE(check_plan(line(on_arm(0), on_arm(1.5)), arm).warnings.empty());
}

TEST(CheckPlan, ARiskStructureOutsideTheBodyOrTheVolumeIsStopped) {
    Plan plan = good_plan();
    const auto with = [&](const Vector3d& centre, const std::optional<VolumeBox>& box = std::nullopt) {
        plan.risk_structures = {{"Nerve", test::ball_mesh(5, 3)}};
        for (auto& p : plan.risk_structures[0].surface.vertices_in_ct) p += centre;
        return check_plan(plan, ball(), box);
    };
    EXPECT_TRUE(with({40, 0, 0}).stops.empty());
    EXPECT_TRUE(with({40, 0, 0}).warnings.empty());
    EXPECT_TRUE(with({79, 0, 0}).stops.empty());
    EXPECT_TRUE(said(with({79, 0, 0}).warnings, "of the risk structure lies outside the body"));
    EXPECT_TRUE(with({86.5, 0, 0}).stops.empty()) << "1.5 mm above the skin: a nerve in the skin, drawn roughly";
    EXPECT_TRUE(said(with({95, 0, 0}).stops, "Nerve: the risk structure lies wholly outside the body, 10."));
    VolumeBox box;
    box.ct_from_voxel.translation() = Vector3d(-90, -90, -90);
    box.size = {181, 181, 181};
    EXPECT_TRUE(with({40, 0, 0}, box).stops.empty());
    box.ct_from_voxel.translation().z() = -58;  // good_plan lies above it
    EXPECT_TRUE(said(with({0, 0, -58}, box).stops, "of the risk structure lies outside the volume"));
    EXPECT_TRUE(said(with({0, 0, -55.2}, box).warnings, "Nerve: a part of the risk structure lies outside"));
}

TEST(CheckPlan, ARiskStructureOnTheOtherSideThanItsNameSaysIsStopped) {
    const SkinSurface head(test::analytic_head_mesh(4));
    Plan plan;
    plan.boreholes.push_back({"B", head.nearest({0, -120, 40}).p_in_ct, {}, 7, 6, {}});
    plan.risk_structures = {{"Facial nerve left", test::ball_mesh(5, 3)}};
    for (auto& p : plan.risk_structures[0].surface.vertices_in_ct) p.x() -= 40;  // LPS: to the right
    EXPECT_TRUE(said(check_plan(plan, head).stops, "Facial nerve left: it is named left and lies"))
        << "a mirrored file is noticed by its name";
}

TEST(CheckPlan, OnlyWordsThatMeanASideClaimOne) {
    for (const char* name :
         {"left", "Left burr hole", "B1 LINKS", "trajectory-links", "L frontal", "T3_L", "incision gauche",
          "Трепанация ЛЕВАЯ", "Скуловая дуга слева", "Левого уха", "Лівий отвір", "Bohrloch li.", "Lt frontal",
          "TrepLeft2", "VÄNSTER sida", "左側頭", "왼쪽 구멍", "ثقب أيسر", "Craniotomie–gauche"})
        EXPECT_EQ(side_named(name), Side::left) << name;
    for (const char* name : {"right",
                             "rechts",
                             "R temporal",
                             "Entry R",
                             "dexter-2",
                             "Правая трепанация",
                             "Трепанация правая",
                             "Bohrloch re.",
                             "Trepan-rt",
                             "Rt frontal",
                             "Burr hole (rt)",
                             "Foramen dext.",
                             "NearRight",
                             "Otwór prawy",
                             "HÖGER",
                             "Foro destro",
                             "右耳",
                             "오른쪽",
                             "الأذن اليمنى",
                             "Sağ taraf: delik sağ"})
        EXPECT_EQ(side_named(name), Side::right) << name;
    for (const char* name :
         {"",         "L",          "R",           "L1",        "R2D2",    "Rand",        "cleft",
          "leftover", "brightness", "left right",  "L to R",    "Schnitt", "V L 3",       "RT plan 1",
          "Re-entry", "Li 2",       "Левкоплакия", "Правило 3", "左右",    "Electrode SN"})
        EXPECT_EQ(side_named(name), std::nullopt) << name;
}

TEST(CheckPlan, TheMiddleOfAHeadIsFoundHoweverItLies) {
    // The analytic head has unequal ears, so its middle is only near x = 0; turned, it must follow.
    const TriangleMesh mesh = test::analytic_head_mesh(4);
    const auto straight = find_mid_plane(SkinSurface(mesh));
    ASSERT_TRUE(straight);
    EXPECT_NEAR(straight->point_in_ct.dot(straight->normal_in_ct), 0, 6);
    for (const double degrees : {-20.0, 20.0}) {
        TriangleMesh turned = mesh;
        const Eigen::Matrix3d turn =
            (Eigen::AngleAxisd(degrees * M_PI / 180, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.1, Vector3d::UnitY()))
                .toRotationMatrix();
        for (auto& p : turned.vertices_in_ct) p = turn * p + Vector3d(100, -50, 30);
        for (auto& n : turned.normals_in_ct) n = turn * n;
        const auto found = find_mid_plane(SkinSurface(turned));
        ASSERT_TRUE(found) << degrees;
        EXPECT_GT(found->normal_in_ct.dot(turn * straight->normal_in_ct), std::cos(4 * M_PI / 180)) << degrees;
    }
}

TEST(CheckPlan, ASideAcrossTheMiddleIsStoppedAndOneNearItIsNot) {
    const SkinSurface head(test::analytic_head_mesh(3));
    const auto hole = [&](const char* name, double x) {
        Plan plan;
        plan.boreholes.push_back({name, head.nearest({x, -120, 40}).p_in_ct, {}, 7, 6, {}});
        return check_plan(plan, head).stops;
    };
    EXPECT_TRUE(hole("B left", 35).empty());  // LPS: x grows to the patient's left
    EXPECT_TRUE(said(hole("B right", 35), "B right: it is named right and lies"));
    EXPECT_TRUE(said(hole("B links", -35), "B links: it is named left and lies"));
    EXPECT_TRUE(hole("B right", -35).empty());
    EXPECT_TRUE(hole("B right", 3).empty());
}

}  // namespace
}  // namespace planlight
