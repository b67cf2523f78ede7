#include "projection/draw_plan.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "projection/place_labels.h"
#include "tests/projection/shapes.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using test::ball;
using test::on_ball;
constexpr double kRadius_mm = test::kBallRadius_mm;

double great_circle_mm(const Vector3d& a, const Vector3d& b) {
    return kRadius_mm * std::atan2(a.cross(b).norm(), a.dot(b));
}

DrawingSettings without_labels() {
    DrawingSettings settings;
    settings.labels = false;
    return settings;
}

std::vector<Stroke> strokes_of(const PlanDrawing& drawing, StrokeKind kind, int item) {
    std::vector<Stroke> found;
    for (const Stroke& s : drawing.strokes)
        if (s.kind == kind && s.item == item) found.push_back(s);
    return found;
}

Vector3d middle(const Stroke& s) {
    const auto n = s.points_in_ct.size();
    return (s.points_in_ct[(n - 1) / 2] + s.points_in_ct[n / 2]) / 2;
}

TEST(DrawPlan, TenMillimetresOfALineAreTenMillimetresAlongABall) {
    Plan plan;
    plan.osteotomy_lines.push_back({"O1", {on_ball(0.2, -0.3), on_ball(1.3, 0.5)}, false, {}});
    const PlanDrawing drawing = draw_plan(plan, ball());
    const auto ticks = strokes_of(drawing, StrokeKind::tick, 0);
    const double whole_mm = great_circle_mm(on_ball(0.2, -0.3), on_ball(1.3, 0.5));
    ASSERT_EQ(ticks.size(), static_cast<std::size_t>(whole_mm / 10) + 1);
    for (std::size_t i = 0; i < ticks.size(); ++i)
        EXPECT_NEAR(great_circle_mm(on_ball(0.2, -0.3), middle(ticks[i])), 10.0 * static_cast<double>(i), 0.1) << i;
    for (std::size_t i = 1; i < ticks.size(); ++i)
        EXPECT_NEAR(great_circle_mm(middle(ticks[i - 1]), middle(ticks[i])), 10, 0.1) << i;
    EXPECT_EQ(drawing.items[0].label, "O1  " + std::to_string(std::lround(whole_mm)) + " mm");
}

TEST(DrawPlan, TicksStandSquareToTheLineAndAreAsLongAsAsked) {
    Plan plan;
    plan.osteotomy_lines.push_back({"", {on_ball(0, 0), on_ball(0.8, 0)}, false, {}});
    const PlanDrawing drawing = draw_plan(plan, ball());
    for (const Stroke& tick : strokes_of(drawing, StrokeKind::tick, 0)) {
        const Vector3d run = (tick.points_in_ct.back() - tick.points_in_ct.front()).normalized();
        EXPECT_GT(std::abs(run.z()),
                  std::cos(std::numbers::pi / 180));  // the line runs along the equator: ticks along z, to 1 degree
        const double length_mm = great_circle_mm(tick.points_in_ct.front(), tick.points_in_ct.back());
        EXPECT_TRUE(std::abs(length_mm - 2) < 0.02 || std::abs(length_mm - 4) < 0.02) << length_mm;
    }
}

TEST(DrawPlan, ABoreholeIsACircleOfItsDiameterOnTheSkin) {
    for (const double diameter_mm : {3.0, 7.0, 14.0, 40.0}) {
        Plan plan;
        plan.boreholes.push_back({"B1", on_ball(0.5, 0.4), {}, diameter_mm, 6, {}});
        const PlanDrawing drawing = draw_plan(plan, ball(), without_labels());
        const auto strokes = strokes_of(drawing, StrokeKind::borehole, 0);
        const auto ring = std::find_if(strokes.begin(), strokes.end(), [](const Stroke& s) { return s.closed; });
        ASSERT_NE(ring, strokes.end());
        double around_mm = 0;
        for (std::size_t i = 0; i < ring->points_in_ct.size(); ++i) {
            const Vector3d& p = ring->points_in_ct[i];
            const Vector3d& next = ring->points_in_ct[(i + 1) % ring->points_in_ct.size()];
            EXPECT_NEAR(2 * great_circle_mm(on_ball(0.5, 0.4), p), diameter_mm, 0.02 * diameter_mm);
            EXPECT_LT((next - p).norm(), 0.55);
            around_mm += great_circle_mm(p, next);
        }
        // A circle on a ball is shorter than pi d by sin(rho)/rho.
        const double rho = diameter_mm / 2 / kRadius_mm;
        EXPECT_NEAR(around_mm, std::numbers::pi * diameter_mm * std::sin(rho) / rho, 0.02 * around_mm);
        EXPECT_EQ(drawing.items[0].label, "B1  ⌀" + std::to_string(std::lround(diameter_mm)) + "  6 mm deep");
    }
}

TEST(DrawPlan, AnglesOfTheCrossAndOfLinesAreTrue) {
    Plan plan;  // two legs that meet at a right angle on the ball: along the equator, then up a meridian
    plan.osteotomy_lines.push_back({"", {on_ball(-0.4, 0), on_ball(0, 0), on_ball(0, 0.4)}, false, {}});
    const PlanDrawing drawing = draw_plan(plan, ball(), without_labels());
    const auto line = strokes_of(drawing, StrokeKind::osteotomy_line, 0).front();
    const auto corner = std::min_element(
        line.points_in_ct.begin(), line.points_in_ct.end(),
        [](const auto& a, const auto& b) { return (a - on_ball(0, 0)).norm() < (b - on_ball(0, 0)).norm(); });
    const Vector3d before = *(corner - 10) - *corner, after = *(corner + 10) - *corner;
    EXPECT_NEAR(std::acos(before.normalized().dot(after.normalized())) * 180 / std::numbers::pi, 90, 1);
}

TEST(DrawPlan, ACutPlanesTraceLiesInItsPlaneAndEndsAtItsExtent) {
    Plan plan;
    plan.cut_planes.push_back({"C1", {80, 0, 10}, Vector3d(0, 0.6, 0.8), Vector3d(0, 0.8, -0.6), 40, 30, {}});
    const PlanDrawing drawing = draw_plan(plan, ball(), without_labels());
    const auto lines = strokes_of(drawing, StrokeKind::cut_plane, 0);
    ASSERT_EQ(lines.size(), 1u);
    double low = 1e9, high = -1e9;
    for (const Vector3d& p : lines[0].points_in_ct) {
        EXPECT_NEAR((p - Vector3d(80, 0, 10)).dot(Vector3d(0, 0.6, 0.8)), 0, 0.02);
        EXPECT_NEAR(p.norm(), kRadius_mm, 0.025);  // sag of the mesh's triangles
        low = std::min(low, (p - Vector3d(80, 0, 10)).dot(Vector3d(0, 0.8, -0.6)));
        high = std::max(high, (p - Vector3d(80, 0, 10)).dot(Vector3d(0, 0.8, -0.6)));
    }
    EXPECT_NEAR(low, -20, 0.05);
    EXPECT_NEAR(high, 20, 0.05);
}

TEST(DrawPlan, AWholeCutIsOneClosedLine) {
    Plan plan;
    plan.cut_planes.push_back({"C1", {0, 0, 10}, Vector3d::UnitZ(), Vector3d::UnitX(), 400, 400, {}});
    const PlanDrawing drawing = draw_plan(plan, ball());
    const auto lines = strokes_of(drawing, StrokeKind::cut_plane, 0);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_TRUE(lines[0].closed);
    EXPECT_EQ(drawing.items[0].label,
              "C1  " + std::to_string(std::lround(2 * std::numbers::pi * std::sqrt(80.0 * 80 - 100))) + " mm");
}

TEST(DrawPlan, TextRunsToTheRightAndStandsUpSeenFromOutside) {
    const Vector3d up(0, 0, 1);
    for (const Vector3d& place : {on_ball(0.1, 0), on_ball(2, 0.7), on_ball(-2.5, -0.9), on_ball(4, 0.2)}) {
        const TextFrame f = text_frame(ball().nearest(place), up);
        const Vector3d outwards = place.normalized();
        EXPECT_GT(f.right_in_ct.cross(f.up_in_ct).dot(outwards), 0.999);  // mirrored text would give -1
        EXPECT_GT(f.up_in_ct.dot(up), 0.3);
        EXPECT_NEAR(f.right_in_ct.dot(up), 0, 1e-3);
    }
    // On top of the head a reader before the face (-y) sees text stand away from him (+y), running to his right (-x).
    const TextFrame top = text_frame(ball().nearest(on_ball(0, std::numbers::pi / 2)), up);
    EXPECT_GT(top.up_in_ct.y(), 0.99);
    EXPECT_GT(top.right_in_ct.x(), 0.99);
}

/// The signs' outlines in a plane that touches the ball at the label's middle: right and up as seen from outside, mm.
struct Flat {
    std::vector<std::vector<Eigen::Vector2d>> outlines;
    Eigen::Vector2d low{1e9, 1e9}, high{-1e9, -1e9};
};
Flat flat(const std::vector<Label::Outlines>& signs) {
    Vector3d middle = Vector3d::Zero();
    for (const auto& sign : signs)
        for (const auto& outline : sign)
            for (const Vector3d& p : outline) middle += p;
    const Vector3d out = middle.normalized(), right = Vector3d(0, 0, 1).cross(out).normalized(), up = out.cross(right);
    Flat drawn;
    for (const auto& sign : signs)
        for (const auto& outline : sign) {
            drawn.outlines.emplace_back();
            for (const Vector3d& p : outline) {
                const double far_mm = great_circle_mm(out, p);
                const Eigen::Vector2d aside = Eigen::Vector2d(p.dot(right), p.dot(up)).normalized();
                drawn.outlines.back().push_back(far_mm * aside);
                drawn.low = drawn.low.cwiseMin(far_mm * aside), drawn.high = drawn.high.cwiseMax(far_mm * aside);
            }
        }
    return drawn;
}

/// A label of one letter, and what `place_label` makes of it on the ball.
Flat letter_on_ball(const std::string& letter, const DrawingSettings& settings = {}) {
    OccupiedSkin free;
    LabelWish wish{0, {letter, {}}, "", {ball().nearest(on_ball(0.3, 0.2))}, 1, {}, {}, {}};
    const auto label = place_label(wish, ball(), settings, free);
    return label ? flat(label->signs_in_ct) : Flat{};
}

TEST(DrawPlan, ALetterIsNotMirroredAndStandsUp) {
    const Flat drawn = letter_on_ball("L");  // its ink: the upright at the left, the foot at the bottom
    ASSERT_EQ(drawn.outlines.size(), 1u);
    double rightmost_above = -1e9, highest_right = -1e9;
    for (const auto& p : drawn.outlines[0]) {
        if (p.y() > 0) rightmost_above = std::max(rightmost_above, p.x());
        if (p.x() > 0.5 * drawn.high.x()) highest_right = std::max(highest_right, p.y());
    }
    EXPECT_LT(rightmost_above, drawn.low.x() + 0.35 * (drawn.high.x() - drawn.low.x()));
    EXPECT_LT(highest_right, drawn.low.y() + 0.35 * (drawn.high.y() - drawn.low.y()));
}

TEST(DrawPlan, CapitalsAndDigitsAreFiveMillimetresHighAlongTheSkin) {
    for (const char* letter : {"H", "E", "T", "1", "7"}) {
        const Flat drawn = letter_on_ball(letter);
        EXPECT_NEAR(drawn.high.y() - drawn.low.y(), 5, 0.1) << letter;
    }
    for (const char* letter : {"B", "O", "8", "3"}) {  // round ones overshoot by a fiftieth at each end
        const Flat drawn = letter_on_ball(letter);
        EXPECT_NEAR(drawn.high.y() - drawn.low.y(), 5.1, 0.2) << letter;
    }
}

TEST(DrawPlan, TextStandsUpForSomebodyAtEachSide) {
    for (const Vector3d& up : {Vector3d(0, 0, 1), Vector3d(0, 0, -1), Vector3d(0, 1, 0)}) {
        DrawingSettings settings;
        settings.up_in_ct = up;
        OccupiedSkin free;
        const LabelWish wish{0, {"L", {}}, "", {ball().nearest(on_ball(0.3, 0.2))}, 1, {}, {}, {}};
        const auto label = place_label(wish, ball(), settings, free);
        ASSERT_TRUE(label);
        // The foot of an L is its broad end: the middle of its ink lies below the middle of its height.
        Vector3d sum = Vector3d::Zero();
        double low = 1e9, high = -1e9, count = 0;
        for (const Vector3d& p : label->signs_in_ct[0][0]) {
            sum += p, ++count;
            low = std::min(low, p.dot(up)), high = std::max(high, p.dot(up));
        }
        EXPECT_LT(sum.dot(up) / count, (low + high) / 2) << up.transpose();
    }
}

/// No label's ink or leader lies on the plan's lines or another's label; a leader does not cross either.
void expect_nothing_overlaps(const PlanDrawing& drawing) {
    const auto points_of = [](const Label& label) {
        std::vector<Vector3d> points = label.leader.points_in_ct;
        for (const auto& sign : label.signs_in_ct)
            for (const auto& outline : sign) points.insert(points.end(), outline.begin(), outline.end());
        return points;
    };
    OccupiedSkin taken;
    for (const Stroke& stroke : drawing.strokes)
        for (const Vector3d& p : stroke.points_in_ct) taken.add(p);
    for (const Label& label : drawing.labels)
        if (!label.of_moment)
            for (const Vector3d& p : points_of(label)) taken.add(p, label.item);
    for (const Label& label : drawing.labels) {
        if (label.of_moment) continue;
        for (const Vector3d& p : points_of(label))
            ASSERT_FALSE(taken.within(p, 0.5, label.item)) << label.words << " lies over something";
    }
}

TEST(DrawPlan, OfACrowdedPlanNoLabelLiesOverAnotherAndTheOthersAreLeftOut) {
    Plan plan;  // 300 holes on a patch of 30 mm: there is skin for the names of a few
    for (int i = 0; i < 300; ++i)
        plan.boreholes.push_back(
            {"Hole " + std::to_string(i), on_ball(0.02 * (i % 20), 0.02 * (i / 20.0)), {}, 2, 5, {}});
    const PlanDrawing drawing = draw_plan(plan, ball());
    ASSERT_EQ(drawing.items.size(), 300u);
    expect_nothing_overlaps(drawing);
    std::set<int> labelled;
    for (const Label& label : drawing.labels)
        if (!label.of_moment) labelled.insert(label.item);
    EXPECT_GT(labelled.size(), 3u);
    EXPECT_LT(labelled.size(), 290u);
    for (int i = 0; i < 300; ++i)
        EXPECT_EQ(drawing.items[static_cast<std::size_t>(i)].labelled, labelled.contains(i)) << i;
}

Plan forehead_plan() {
    const auto at = [](double x, double z) {
        Vector3d p(x, -130, z);
        while (test::analytic_head_distance(p) > 1e-4) p.y() += test::analytic_head_distance(p);
        return p;
    };
    Plan plan;
    plan.osteotomy_lines.push_back(
        {"Osteotomy",
         {at(-32, 26), at(0, 24), at(32, 26), at(33, 50), at(30, 76), at(0, 78), at(-30, 76), at(-33, 50)},
         true,
         {}});
    plan.boreholes = {{"B1", at(-32, 26), {}, 7, 6, {}},
                      {"B2", at(32, 26), {}, 7, 6, {}},
                      {"B3", at(30, 76), {}, 7, 6, {}},
                      {"B4", at(-30, 76), {}, 7, 6, {}}};
    plan.trajectories.push_back({"T1", at(4, 52), at(4, 52) + Vector3d(18, 55, -12), 0, {}});
    return plan;
}

TEST(DrawPlan, LabelsOverlapNothingOnAHead) {
    const SkinSurface head(test::analytic_head_mesh(2));
    const PlanDrawing drawing = draw_plan(forehead_plan(), head);
    ASSERT_EQ(drawing.items.size(), 6u);
    for (const auto& item : drawing.items) EXPECT_TRUE(item.warnings.empty()) << item.warnings.front();
    EXPECT_EQ(std::count_if(drawing.labels.begin(), drawing.labels.end(), [](const Label& l) { return !l.of_moment; }),
              6);
    expect_nothing_overlaps(drawing);
}

TEST(DrawPlan, EveryStrokeLiesOnTheSkinInSmallSteps) {
    const SkinSurface head(test::analytic_head_mesh(2));
    const DrawingSettings settings;
    for (const Stroke& s : draw_plan(forehead_plan(), head, settings).strokes)
        for (std::size_t i = 0; i < s.points_in_ct.size(); ++i) {
            EXPECT_LT(std::abs(test::analytic_head_distance(s.points_in_ct[i])),
                      0.15);  // sag of 2 mm edges at small radii
            EXPECT_NEAR(s.normals_in_ct[i].norm(), 1, 1e-9);
            if (i > 0) {
                EXPECT_LT((s.points_in_ct[i] - s.points_in_ct[i - 1]).norm(), settings.max_segment_mm + 0.06);
            }
        }
}

TEST(DrawPlan, APlanOfAnotherFrameIsNotDrawn) {
    Plan plan;
    plan.boreholes.push_back({"B1", on_ball(0, 0) * 2, {}, 7, 6, {}});
    const PlanDrawing drawing = draw_plan(plan, ball());
    EXPECT_TRUE(drawing.strokes.empty());
    ASSERT_EQ(drawing.items.size(), 1u);
    EXPECT_FALSE(drawing.items[0].warnings.empty());
}

}  // namespace
}  // namespace planlight
