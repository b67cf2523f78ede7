#include "projection/skin_now.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "projection/render_drawing.h"
#include "tests/projection/shapes.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using test::ball;
using test::on_ball;

constexpr double kRadius_mm = test::kBallRadius_mm;

/// The ball's side towards +x was scanned, `mm(p)` off the CT's.
template <class Mm>
SkinDisplacementField scanned(const Mm& mm) {
    SkinDisplacement d;
    d.apart_mm = 4, d.offset_mm = -0.5, d.spread_mm = 0.3, d.alike_over_mm = 25;
    for (double longitude = -1; longitude <= 1; longitude += 0.05)
        for (double latitude = -1; latitude <= 1; latitude += 0.05) {
            const Vector3d p = on_ball(longitude, latitude);
            d.places.push_back({p, mm(p), 0.01});
        }
    return SkinDisplacementField(d);
}

DrawingSettings without_labels() {
    DrawingSettings settings;
    settings.labels = false;
    return settings;
}

TEST(SkinNow, LiesWhereTheScanFoundIt) {
    const SkinSurface now = skin_as_scanned(ball().mesh(), scanned([](auto&) { return -0.5; }));
    for (const double a : {-0.7, 0.0, 0.6})
        EXPECT_NEAR(now.nearest(on_ball(a, 0.2)).p_in_ct.norm(), kRadius_mm - 0.5, 0.03);  // facets of the ball
    const SkinSurface same = skin_as_scanned(ball().mesh(), SkinDisplacementField(SkinDisplacement()));
    EXPECT_EQ(same.mesh().vertices_in_ct, ball().mesh().vertices_in_ct);
}

// 100 mm on the CT's skin are 97.5 mm on skin that lies 2 mm deeper; the plan's page says 100, and so must the light.
TEST(SkinNow, ALineIsCalledByItsPlannedLength) {
    const SkinSurface now = skin_as_scanned(ball().mesh(), scanned([](auto&) { return -2.; }));
    OsteotomyLine line;
    line.name = "Cut";
    for (int i = 0; i <= 20; ++i) line.points_in_ct.push_back(on_ball(100 / kRadius_mm * (i / 20.0 - 0.5), 0));
    Plan plan;
    plan.osteotomy_lines.push_back(line);
    const PlanDrawing drawing = draw_plan(plan, ball(), now);
    ASSERT_FALSE(drawing.labels.empty());
    EXPECT_NE(drawing.labels.front().words.find("100 mm"), std::string::npos) << drawing.labels.front().words;
}

// A plane of 130 mm cuts another length of skin that lies 4 mm deeper; the plan's page says the CT's, and so must the
// light.
TEST(SkinNow, ACutPlaneIsCalledByItsPlannedLength) {
    const SkinSurface now = skin_as_scanned(ball().mesh(), scanned([](auto&) { return -4.; }));
    Plan plan;
    plan.cut_planes.push_back({"C", on_ball(0, 0), Vector3d::UnitZ(), Vector3d::UnitY(), 130, 120, {}});
    const auto words = [&](const SkinSurface& skin) {
        const PlanDrawing drawing = draw_plan(plan, ball(), skin);
        return drawing.labels.empty() ? std::string("no label") : drawing.labels.front().words;
    };
    const double planned_mm = 2 * kRadius_mm * std::asin(65 / kRadius_mm);
    EXPECT_EQ(words(now), fmt::format("C\n{:.0f} mm", planned_mm));
    EXPECT_EQ(words(now), words(ball()));
    const double now_mm = 2 * (kRadius_mm - 4) * std::asin(65 / (kRadius_mm - 4));
    EXPECT_GT(std::abs(planned_mm - now_mm), 1) << "or else it would not be noticed";
}

// Skin 2 mm deeper, an axis that leans by 45 degrees: the place on the skin moves aside by 2 mm. The nearest point
// would not.
TEST(SkinNow, AHoleStaysOnItsAxis) {
    const SkinSurface now = skin_as_scanned(ball().mesh(), scanned([](auto&) { return -2.; }));
    const Vector3d p = on_ball(0, 0);
    const Vector3d axis = (-p.normalized() + Vector3d::UnitZ()).normalized();
    Plan plan;
    plan.boreholes.push_back({"B", p, axis, 7, 0, {}});
    plan.trajectories.push_back({"T", p, p + 30 * axis, 0, {}});
    const PlanDrawing drawing = draw_plan(plan, ball(), now, without_labels());
    for (const DrawnItem& item : drawing.items) {
        const Vector3d off = item.anchor_in_ct - p;
        EXPECT_NEAR((off - off.dot(axis) * axis).norm(), 0, 1e-6) << item.name;
        EXPECT_NEAR(item.anchor_in_ct.norm(), kRadius_mm - 2, 0.05) << item.name;
        EXPECT_NEAR(item.anchor_in_ct.z(), 2, 0.1) << item.name;
        EXPECT_TRUE(item.warnings.empty() || item.warnings[0].find("diameter") == std::string::npos);
    }
}

// Planned on the CT's skin, 75 degrees from the perpendicular, and the skin swelled by 6 mm: the axis meets it 20 mm
// away. Where it sank by 6 mm the axis passes it by, 3 mm away: nothing is drawn beside the axis.
TEST(SkinNow, AnObliqueAxisIsFollowedHoweverMuchTheSkinSwelled) {
    const Vector3d p = on_ball(0, 0);
    const double theta = 75 * M_PI / 180;
    const Vector3d axis(-std::cos(theta), 0, std::sin(theta));
    Plan plan;
    plan.boreholes.push_back({"B", p, axis, 7, 5, {}});
    plan.trajectories.push_back({"T", p, p + 30 * axis, 2, {}});
    const SkinSurface swollen(test::ball_mesh(kRadius_mm + 6, 5)), sunk(test::ball_mesh(kRadius_mm - 6, 5));
    for (const DrawnItem& item : draw_plan(plan, ball(), swollen, without_labels()).items) {
        EXPECT_NEAR((item.anchor_in_ct - p).cross(axis).norm(), 0, 1e-6) << item.name;
        EXPECT_NEAR(item.anchor_in_ct.norm(), kRadius_mm + 6, 0.05) << item.name;
        EXPECT_GT((item.anchor_in_ct - p).norm(), 15) << "or else it would not be noticed";
        EXPECT_TRUE(item.warnings.empty()) << item.warnings[0];
    }
    const PlanDrawing past = draw_plan(plan, ball(), sunk, without_labels());
    EXPECT_TRUE(past.strokes.empty());
    for (const DrawnItem& item : past.items) {
        ASSERT_FALSE(item.warnings.empty());
        EXPECT_NE(item.warnings.back().find(item.name + ": as the skin lies now, its axis does not meet the skin"),
                  std::string::npos)
            << item.warnings.back();
    }
}

TEST(SkinNow, ALineIsCarriedWithTheSkinItWasPlannedOn) {
    // Planned 8 mm under the skin, as on the bone: its place is on the CT's skin over it, and goes in with that.
    const auto slope = [](const Vector3d& p) { return -0.5 + 0.02 * p.y(); };
    const SkinSurface now = skin_as_scanned(ball().mesh(), scanned(slope));
    Plan plan;
    plan.osteotomy_lines.push_back({"O", {on_ball(-0.2, 0) * 0.9, on_ball(0.2, 0) * 0.9}, false, {}});
    const PlanDrawing drawing = draw_plan(plan, ball(), now, without_labels());
    ASSERT_FALSE(drawing.strokes.empty());
    const Vector3d first = drawing.strokes[0].points_in_ct.front();
    const Vector3d planned = draw_plan(plan, ball(), without_labels()).strokes[0].points_in_ct.front();
    EXPECT_LT(first.cross(planned.normalized()).norm(), 0.02) << "straight over or under the place on the CT's skin";
    EXPECT_NEAR(first.norm() - planned.norm(), slope(planned), 0.02);
    EXPECT_NEAR(drawing.items[0].distance_to_skin_mm, 8, 0.05) << "of the CT's skin, not of this one";
}

TEST(SkinNow, ACutPlaneStaysInItsPlane) {
    const SkinSurface now = skin_as_scanned(ball().mesh(), scanned([](auto&) { return -2.; }));
    Plan plan;
    const Vector3d normal = Vector3d(1, 0, 2).normalized();
    plan.cut_planes.push_back({"C", on_ball(0, 0), normal, Vector3d::UnitY(), 60, 60, {}});
    const PlanDrawing drawing = draw_plan(plan, ball(), now, without_labels());
    ASSERT_FALSE(drawing.strokes.empty());
    for (const Vector3d& p : drawing.strokes[0].points_in_ct) {
        EXPECT_NEAR(normal.dot(p - on_ball(0, 0)), 0, 0.02);
        EXPECT_NEAR(p.norm(), kRadius_mm - 2, 0.06);
    }
}

TEST(SkinNow, WhatTheScanDidNotSeeIsSaid) {
    const auto field = scanned([](auto&) { return -0.5; });
    const SkinSurface now = skin_as_scanned(ball().mesh(), field);
    Plan plan;
    plan.boreholes.push_back({"seen", on_ball(0, 0), {}, 7, 5, {}});
    plan.boreholes.push_back({"unseen", on_ball(2.5, 0), {}, 7, 5, {}});
    PlanDrawing drawing = draw_plan(plan, ball(), now, without_labels());
    warn_of_unscanned(field, drawing, drawing);
    EXPECT_TRUE(drawing.items[0].warnings.empty());
    ASSERT_EQ(drawing.items[1].warnings.size(), 1u);
    EXPECT_NE(drawing.items[1].warnings[0].find("unseen: 100 % of it lies where the scan saw no skin"),
              std::string::npos)
        << drawing.items[1].warnings[0];
    EXPECT_NEAR(drawing.items[1].anchor_in_ct.norm(), kRadius_mm - 0.5, 0.05) << "the offset is taken there";
}

/// How many separate pieces of light lie round the ring, and how much of it is lit.
struct RingLight {
    int pieces = 0;
    double share = 0;
};
RingLight light_round(const RgbImage& picture, const CameraModel& projector, const Stroke& ring) {
    std::vector<bool> lit;
    for (const Vector3d& p : ring.points_in_ct) {
        const auto pixel = project(projector, p);
        const int x = pixel ? static_cast<int>(std::lround(pixel->x())) : -1,
                  y = pixel ? static_cast<int>(std::lround(pixel->y())) : -1;
        lit.push_back(pixel && x >= 0 && y >= 0 && x < picture.width && y < picture.height &&
                      picture.at(x, y)[1] > 100);
    }
    RingLight light;
    for (std::size_t i = 0; i < lit.size(); ++i) {
        light.pieces += lit[i] && !lit[(i + 1) % lit.size()];
        light.share += lit[i] / static_cast<double>(lit.size());
    }
    return light;
}

// At 72 degrees of slope a circle of 14 mm reaches from 67 to 77: beyond 75 nothing is drawn.
TEST(SkinNow, ACircleThatCanBeLitInPartOnlyIsDrawnBrokenAndSaid) {
    const CameraModel projector =
        test::projector_looking_at(Vector3d::Zero(), Vector3d::UnitX(), 560, Vector3d::UnitZ());
    const DrawingRenderer renderer(ball(), projector);
    for (const bool steep : {false, true}) {
        Plan plan;
        const double slope = steep ? 72 * M_PI / 180 : 40 * M_PI / 180;
        const double longitude = slope - std::asin(std::sin(slope) * kRadius_mm / 560.);  // the light is not parallel
        plan.boreholes.push_back({"B1", on_ball(longitude, 0), {}, 14, 5, {}});
        PlanDrawing drawing = draw_plan(plan, ball(), without_labels());
        std::erase_if(drawing.strokes, [](const Stroke& s) { return !s.closed; });
        RgbImage picture;
        const RenderCounts counts = renderer.render_into(picture, drawing, RigidTransform::Identity());
        const RingLight light = light_round(picture, projector, drawing.strokes[0]);
        if (!steep) {
            EXPECT_TRUE(counts.partly_lit.empty());
            EXPECT_EQ(light.pieces, 0) << "one closed ring";
            EXPECT_NEAR(light.share, 1, 1e-9);
            continue;
        }
        ASSERT_EQ(counts.partly_lit.size(), 1u);
        EXPECT_EQ(counts.partly_lit[0].item, 0);
        EXPECT_GT(counts.partly_lit[0].lit_share, 0.2);
        EXPECT_LT(counts.partly_lit[0].lit_share, 0.85);
        EXPECT_GT(light.pieces, 3) << "dashes";
        const auto said = sentences(counts.partly_lit, drawing);
        ASSERT_EQ(said.size(), 1u);
        EXPECT_EQ(said[0].rfind("B1: only ", 0), 0u) << said[0];
        test::keep_picture(picture, "broken_circle");
    }
}

// A line that ends where the light does looks like one that is planned to end there. The skin normal is 75 degrees from
// the light at a longitude of 75 degrees less what the light's rays run apart.
TEST(SkinNow, ALineThatGoesOnWhereTheLightEndsIsSaidWithItsShare) {
    const CameraModel projector =
        test::projector_looking_at(Vector3d::Zero(), Vector3d::UnitX(), 560, Vector3d::UnitZ());
    const DrawingRenderer renderer(ball(), projector);
    Plan plan;
    constexpr double kTo = 2.0;
    OsteotomyLine round{"Around", {}, false, {}}, front{"Front", {}, false, {}}, back{"Back", {}, false, {}};
    for (int i = 0; i <= 40; ++i) {
        round.points_in_ct.push_back(on_ball(kTo * i / 40, 0));
        front.points_in_ct.push_back(on_ball(0.5 * i / 40, 0.3));
        back.points_in_ct.push_back(on_ball(3 + 0.2 * i / 40, 0.3));
    }
    plan.osteotomy_lines = {round, front, back};
    PlanDrawing drawing = draw_plan(plan, ball(), without_labels());
    std::erase_if(drawing.strokes, [](const Stroke& s) { return s.kind != StrokeKind::osteotomy_line; });
    // A mark for the cameras beside the line in front, where no light falls, is not the line.
    Stroke mark = drawing.strokes.back();
    mark.kind = StrokeKind::check_mark;
    mark.item = 1;
    drawing.strokes.push_back(mark);
    RgbImage picture;
    const RenderCounts counts = renderer.render_into(picture, drawing, RigidTransform::Identity());
    ASSERT_EQ(counts.items.size(), 3u);
    const double slope = 1.31, end = slope - std::asin(std::sin(slope) * kRadius_mm / 560.);
    const PointCounts& light = counts.items[0];
    EXPECT_NEAR(light.lit_share(), end / kTo, 0.03);
    EXPECT_EQ(light.lit + light.too_steep + light.hidden + light.outside, light.points);
    EXPECT_EQ(counts.items[1].lit, counts.items[1].points);
    EXPECT_EQ(counts.items[2].lit, 0u);
    const auto said = sentences_of_unlit(counts, drawing);
    ASSERT_EQ(said.size(), 3u) << "of the line in front there is nothing to say; what to do is said once";
    const double percent = 5 * std::round(20 * (1 - end / kTo));
    EXPECT_EQ(said[0].rfind(fmt::format("Around: about {:.0f} % of it has no light (", percent), 0), 0u) << said[0];
    EXPECT_EQ(said[1], "Back: no light reaches it from here.");
}

}  // namespace
}  // namespace planlight
