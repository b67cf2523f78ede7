// Where an item comes to lie on the skin: along its axis, and not where the scan shows none.
#include "projection/skin_place.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "projection/draw_plan.h"
#include "tests/projection/shapes.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using test::ball;
constexpr double kRadius_mm = test::kBallRadius_mm;

DrawingSettings without_labels() {
    DrawingSettings settings;
    settings.labels = false;
    return settings;
}

std::vector<Stroke> cut_strokes(const PlanDrawing& drawing) {
    std::vector<Stroke> found;
    std::ranges::copy_if(drawing.strokes, std::back_inserter(found),
                         [](const Stroke& s) { return s.kind == StrokeKind::cut_plane; });
    return found;
}

/// Of the item's place on the skin, mm.
double beside_mm(const DrawnItem& item, const Vector3d& p, const Vector3d& axis) {
    return (item.anchor_in_ct - p).cross(axis.normalized()).norm();
}

bool says(const DrawnItem& item, const std::string& words) {
    return std::any_of(item.warnings.begin(), item.warnings.end(),
                       [&](const std::string& w) { return w.find(words) != std::string::npos; });
}

// Planned on the bone 8 mm under flat skin: an axis of theta to the perpendicular meets the skin 8 tan(theta) aside of
// the nearest place, however far that is.
TEST(SkinPlace, AHoleIsDrilledAlongItsAxisElseSquareToTheSkin) {
    const SkinSurface& skin = ball();
    const Vector3d out = Vector3d(1, 2, 3).normalized();
    Borehole hole{"H", 58 * out, std::nullopt, 7, 10, std::nullopt};
    EXPECT_GT(drilling_direction(hole, skin).dot(-out), 0.999) << "towards the middle of a ball";
    hole.axis_in_ct = Vector3d(0, 0, -2);
    EXPECT_LT((drilling_direction(hole, skin) - Vector3d(0, 0, -1)).norm(), 1e-12);
}

TEST(SkinPlace, AnObliqueAxisIsFollowedToTheSkin) {
    const SkinSurface sheet(test::sheet_mesh(200, 4));
    for (const double degrees : {0., 30., 59., 61., 65., 70., 80.}) {
        const double theta = degrees * std::numbers::pi / 180;
        const Vector3d entry(3, 2, -8), inwards(std::sin(theta), 0, -std::cos(theta));
        Plan plan;
        plan.boreholes.push_back({"B", entry, inwards, 7, 5, {}});
        plan.trajectories.push_back({"T", entry, entry + 60 * inwards, 2, {}});
        for (const DrawnItem& item : draw_plan(plan, sheet, without_labels()).items) {
            EXPECT_NEAR(beside_mm(item, entry, inwards), 0, 1e-6) << item.name << ' ' << degrees;
            EXPECT_NEAR(item.anchor_in_ct.x(), 3 - 8 * std::tan(theta), 1e-6) << item.name << ' ' << degrees;
            const double along_mm = 8 / std::cos(theta);
            EXPECT_EQ(says(item, "its axis meets the skin"), along_mm > 10) << item.name << ' ' << degrees;
        }
    }
}

// Over the entry lies an ear: the way in leaves the head 8 mm outwards, and passes the ear beyond.
TEST(SkinPlace, OfAllCrossingsOfAnAxisTheOneNextToTheEntryIsThePlace) {
    const SkinSurface head(test::both(test::ball_mesh(80, 5), test::ball_mesh(10, 3), {93, 0, 0}));
    Plan plan;
    const auto way_in = [&](double x_mm) {
        plan.trajectories.push_back({"T", {x_mm, 0.3, 0.2}, {20, 0.3, 0.2}, 2, {}});
    };
    way_in(72);    // on the bone
    way_in(79.9);  // a little under the skin
    way_in(82);    // over the skin, 1 mm from the ear and 2 from the scalp
    for (const DrawnItem& item : draw_plan(plan, head, without_labels()).items)
        EXPECT_NEAR(item.anchor_in_ct.x(), 80, 0.1) << item.name;
    // And planned from the ear: 2 mm within it, its skin is the place.
    Plan on_ear;
    on_ear.trajectories.push_back({"T", {101, 0.3, 0.2}, {20, 0.3, 0.2}, 2, {}});
    EXPECT_NEAR(draw_plan(on_ear, head, without_labels()).items[0].anchor_in_ct.x(), 103, 0.1);
}

// Its axis passes the ball at 3 mm, and at 1 mm.
TEST(SkinPlace, WhatLiesBesideItsAxisIsSaidAndBeyondTwoMillimetresNotDrawn) {
    const auto drawn = [](double over_mm) {
        Plan plan;
        plan.boreholes.push_back({"B", {kRadius_mm + over_mm, 0, 0}, Vector3d::UnitZ(), 7, 5, {}});
        return draw_plan(plan, ball(), without_labels());
    };
    EXPECT_TRUE(drawn(3).strokes.empty());
    EXPECT_TRUE(says(drawn(3).items[0],
                     "B: its axis does not meet the skin within 60 mm of its position; the nearest "
                     "place on the skin lies 3.0 mm beside the axis; it is not drawn"))
        << drawn(3).items[0].warnings[0];
    EXPECT_FALSE(drawn(1).strokes.empty());
    EXPECT_TRUE(says(drawn(1).items[0], "it is drawn 1.0 mm beside the axis")) << drawn(1).items[0].warnings[0];
}

// A head of 90 mm that the scan cut at z = 50: a coronal plane of 80 mm about z = 40 runs over skin from z = 0 to 50 on
// either side. The lid between is no skin.
TEST(SkinPlace, ACutPlaneEndsWhereTheVolumeEnds) {
    Plan plan;
    plan.cut_planes.push_back({"Coronal", {0, 3, 40}, Vector3d::UnitY(), Vector3d::UnitX(), 200, 80, {}});
    const PlanDrawing drawing = draw_plan(plan, SkinSurface(test::cut_ball_mesh(90, 50)));
    const auto lines = cut_strokes(drawing);
    ASSERT_EQ(lines.size(), 2u);
    const double rim_mm = std::sqrt(90 * 90 - 50 * 50);
    for (const Stroke& line : lines)
        for (const Vector3d& p : line.points_in_ct) EXPECT_GT(std::hypot(p.x(), p.y()), rim_mm - 0.1);
    EXPECT_EQ(drawing.items[0].label, "Coronal  " + std::to_string(std::lround(90 * std::asin(50. / 90))) + " mm");
    EXPECT_TRUE(says(drawing.items[0],
                     "its cut reaches the end of the volume, where the scan ends: it is drawn and "
                     "measured up to there"));
    // A lid over the mouth is bridged, and said.
    const PlanDrawing bridged = draw_plan(plan, SkinSurface(test::cut_ball_mesh(90, 50, kSeal)));
    EXPECT_EQ(cut_strokes(bridged).size(), 1u);
    EXPECT_TRUE(says(bridged.items[0], "mm of it run over lids over openings"));
}

}  // namespace
}  // namespace planlight
