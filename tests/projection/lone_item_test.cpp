// A plan of a single item, as most biopsies and many drills are: can the cameras tell where its light lies?
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "projection/stroke_places.h"
#include "tests/projection/shapes.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// Stretches whose light the cameras can tell apart from other light, and how well they tell the direction that they
/// tell worse: as many full stretches square to it.
struct Told {
    int stretches = 0;
    double worse_direction = 0;
};

Told told_of(const Plan& plan) {
    const PlanDrawing drawing = draw_plan(plan, test::ball(), {});
    Told told;
    Eigen::Matrix3d sides = Eigen::Matrix3d::Zero();
    for (const StrokeSegment& segment : segments_of(drawing, {})) {
        ++told.stretches;
        sides += segment.middle().sideways_in_ct * segment.middle().sideways_in_ct.transpose();
    }
    told.worse_direction =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sides, Eigen::EigenvaluesOnly).eigenvalues()[1];
    return told;
}

void expect_told(const Plan& plan, const std::string& what) {
    const Told told = told_of(plan);
    std::printf("%-50s %d stretches, %.1f in the worse direction\n", what.c_str(), told.stretches,
                told.worse_direction);
    EXPECT_GE(told.stretches, 5) << what;  // LightGateSettings::least_seen
    EXPECT_GT(told.worse_direction, 1) << what;
}

const Vector3d kAt = test::on_ball(0.3, 0.4), kInwards = -kAt.normalized();

TEST(LoneItem, AHoleOfAnyDiameterIsToldInBothDirections) {
    for (const double diameter_mm : {0.0, 1.5, 2.0, 2.4, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 12.0, 14.0, 20.0}) {
        Plan plan;
        plan.boreholes.push_back({"B1", kAt, kInwards, diameter_mm, 10, {}});
        expect_told(plan, "hole of " + std::to_string(diameter_mm));
    }
}

TEST(LoneItem, ATrajectoryStraightInOrAslantIsToldInBothDirections) {
    for (const double diameter_mm : {0.0, 2.0, 6.0, 8.0, 12.0})
        for (const double aslant_deg : {0.0, 20.0, 60.0}) {
            const double aslant = aslant_deg * std::numbers::pi / 180;
            Trajectory way;
            way.name = "T1";
            way.entry_in_ct = kAt;
            way.target_in_ct = kAt + 60 * (std::cos(aslant) * kInwards + std::sin(aslant) * kInwards.unitOrthogonal());
            way.diameter_mm = diameter_mm;
            Plan plan;
            plan.trajectories.push_back(way);
            expect_told(plan, "trajectory of " + std::to_string(diameter_mm) + ", " + std::to_string(aslant_deg));
        }
}

TEST(LoneItem, AStraightLineIsToldAlongItselfAsWell) {
    for (const double length_mm : {6.0, 8.0, 12.0, 20.0, 30.0, 60.0}) {
        Plan plan;
        plan.osteotomy_lines.push_back(
            {"Cut", {kAt, test::on_ball(0.3 + length_mm / (test::kBallRadius_mm * std::cos(0.4)), 0.4)}, false, {}});
        expect_told(plan, "line of " + std::to_string(length_mm));
    }
}

int marks_of(const PlanDrawing& drawing, int item) {
    return static_cast<int>(std::count_if(drawing.strokes.begin(), drawing.strokes.end(), [&](const Stroke& s) {
        return s.kind == StrokeKind::check_mark && s.item == item;
    }));
}

TEST(CheckMarks, AreNotAddedWhereAnItemTellsEnoughByItself) {
    Plan plan;
    plan.boreholes.push_back({"B1", kAt, kInwards, 14, 10, {}});
    EXPECT_EQ(marks_of(draw_plan(plan, test::ball(), {}), 0), 0);
    plan.boreholes.front().diameter_mm = 2;
    EXPECT_EQ(marks_of(draw_plan(plan, test::ball(), {}), 0), 4);
    DrawingSettings without;
    without.check_marks = false;
    EXPECT_EQ(marks_of(draw_plan(plan, test::ball(), without), 0), 0);
}

/// Six screws of a plate, 7 mm apart, and a sticker beside: each mark keeps off all that is not its own.
TEST(CheckMarks, KeepOffOtherLightLabelsAndMarkers) {
    Plan plan;
    for (int i = 0; i < 6; ++i) {
        const Vector3d at = test::on_ball(0.3 + i * 7.0 / test::kBallRadius_mm, 0.2);
        plan.boreholes.push_back({"S" + std::to_string(i), at, Vector3d(-at.normalized()), 2.4, 8, {}});
    }
    DrawingSettings settings;
    const Vector3d sticker = test::on_ball(0.3, 0.2 + 14 / test::kBallRadius_mm);
    settings.keep_clear_in_ct = {sticker};
    settings.card = {"E. M.", "LEFT"};
    const PlanDrawing drawing = draw_plan(plan, test::ball(), settings);
    double nearest_mm = 1e9;
    int marks = 0;
    for (const Stroke& mark : drawing.strokes) {
        if (mark.kind != StrokeKind::check_mark) continue;
        ++marks;
        for (const Vector3d& p : mark.points_in_ct) {
            EXPECT_GT((p - sticker).norm(), settings.keep_clear_radius_mm);
            const auto keep = [&](const Vector3d& q) { nearest_mm = std::min(nearest_mm, (q - p).norm()); };
            for (const Stroke& other : drawing.strokes)
                if (other.item != mark.item) std::for_each(other.points_in_ct.begin(), other.points_in_ct.end(), keep);
            for (const Label& label : drawing.labels) {
                std::for_each(label.field_in_ct.begin(), label.field_in_ct.end(), keep);
                std::for_each(label.leader.points_in_ct.begin(), label.leader.points_in_ct.end(), keep);
            }
            ASSERT_TRUE(drawing.card);
            std::for_each(drawing.card->field_in_ct.begin(), drawing.card->field_in_ct.end(), keep);
        }
    }
    EXPECT_GE(marks, 3);
    EXPECT_GE(nearest_mm, 2.9);
}

}  // namespace
}  // namespace planlight
