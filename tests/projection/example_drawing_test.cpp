#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cstdio>
#include <ctime>

#include "projection/place_all_labels.h"
#include "projection/render_drawing.h"
#include "projection/stroke_places.h"
#include "tests/projection/shapes.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// Before the face at that place, on the skin.
Vector3d on_face(double x, double z) {
    Vector3d p(x, -130, z);
    while (test::analytic_head_distance(p) > 1e-4) p.y() += test::analytic_head_distance(p);
    return p;
}

/// A closed cut round 60 x 50 mm of the forehead, four boreholes at its corners, a trajectory in its middle.
Plan forehead_plan() {
    Plan plan;
    plan.osteotomy_lines.push_back(
        {"Osteotomy", {on_face(-30, 26), on_face(30, 26), on_face(30, 76), on_face(-30, 76)}, true, {}});
    plan.boreholes = {{"B1", on_face(-30, 26), {}, 7, 6, {}},
                      {"B2", on_face(30, 26), {}, 7, 6, {}},
                      {"B3", on_face(30, 76), {}, 7, 6, {}},
                      {"B4", on_face(-30, 76), {}, 7, 6, {}}};
    plan.trajectories.push_back({"T1", on_face(4, 52), on_face(4, 52) + Vector3d(18, 55, -12), 0, {}});
    plan.cut_planes.push_back(
        {"C1", on_face(3, -85), Vector3d(0.1, 0, 1).normalized(), Vector3d(1, 0, -0.1).normalized(), 60, 60, {}});
    return plan;
}

TEST(ExampleDrawing, AForeheadPlanIsLitByAFrontalProjector) {
    const SkinSurface head(test::analytic_head_mesh(1.5));
    const CameraModel projector = test::projector_looking_at({0, 0, 30}, {0.1, -1, 0.15}, 750, {0, 0, 1});
    DrawingSettings settings;
    settings.light = LightView{projector, RigidTransform::Identity()};
    const std::clock_t began = std::clock();
    const PlanDrawing drawing = draw_plan(forehead_plan(), head, settings);
    std::printf("drawn in %.0f ms of processor time, %.0f %% of the light is text\n",
                1000 * static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC, 100 * share_of_text(drawing));
    const DrawingRenderer renderer(head, projector);
    RgbImage picture;
    RenderCounts counts;
    double best_ms = 1e9;
    const std::clock_t cpu = std::clock();
    for (int i = 0; i < 12; ++i) {
        const auto start = std::chrono::steady_clock::now();
        counts = renderer.render_into(picture, drawing, RigidTransform::Identity());
        best_ms = std::min(best_ms,
                           std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    const double cpu_ms = 1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC / 12;
    test::keep_picture(picture, "forehead.png");
    std::printf(
        "picture 1920x1080: %.2f ms (%.2f ms of processor time), %zu points, %zu lit, %zu too steep, %zu hidden\n",
        best_ms, cpu_ms, counts.points, counts.lit, counts.too_steep, counts.hidden);
    RecordProperty("picture_ms", std::to_string(best_ms));
    EXPECT_GT(counts.lit, 0.95 * static_cast<double>(counts.points));
}

/// Stretches of each item's light that the cameras can tell apart from other light.
std::vector<int> told_stretches(const PlanDrawing& drawing) {
    std::vector<int> told(drawing.items.size(), 0);
    for (const StrokeSegment& segment : segments_of(drawing, {})) ++told[static_cast<std::size_t>(segment.item)];
    return told;
}

// A hole at the corner of a cut has two lines beside its ring already: a leader that begins at the ring leaves nothing.
TEST(ExampleDrawing, ALeaderTakesNoLightAwayFromTheItemThatItNames) {
    const SkinSurface head(test::analytic_head_mesh(1.5));
    int leaders = 0;
    for (const double aside : {-0.5, 0.1, 0.6}) {
        DrawingSettings settings;
        settings.light = LightView{test::projector_looking_at({0, 0, 30}, {aside, -1, 0.15}, 750, {0, 0, 1}),
                                   RigidTransform::Identity()};
        PlanDrawing drawing = draw_plan(forehead_plan(), head, settings);
        const std::vector<int> with = told_stretches(drawing);
        for (Label& label : drawing.labels) {
            leaders += !label.leader.points_in_ct.empty();
            label.leader.points_in_ct.clear();
        }
        EXPECT_EQ(with, told_stretches(drawing));
        for (std::size_t i = 0; i < with.size(); ++i) EXPECT_GT(with[i], 0) << drawing.items[i].name;
    }
    EXPECT_GT(leaders, 0) << "this test tells nothing";
}

}  // namespace
}  // namespace planlight
