#include <gtest/gtest.h>
#include <vtkGenericOpenGLRenderWindow.h>

#include <Eigen/Geometry>
#include <cmath>
#include <future>

#include "app/live/clickable_scan.h"
#include "app/windows/headless_gl.h"
#include "app/windows/landmark_clicks.h"
#include "app/windows/render_target.h"
#include "app/windows/scene.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

TEST(LandmarkClicks, AreTakenInAnyOrderAndOneSideIsAtMostOneAhead) {
    LandmarkClicks clicks;
    clicks.click_scan({1, 0, 0});
    clicks.click_skin({10, 0, 0});
    clicks.click_skin({20, 0, 0});
    clicks.click_skin({21, 0, 0});  // the same landmark, at a better place
    EXPECT_EQ(clicks.pairs().size(), 1u);
    clicks.click_scan({2, 0, 0});
    ASSERT_EQ(clicks.pairs().size(), 2u);
    EXPECT_EQ(clicks.pairs()[1].name, "2");
    EXPECT_EQ(clicks.pairs()[1].in_ct, Vector3d(21, 0, 0));
    EXPECT_EQ(clicks.pairs()[1].in_rig, Vector3d(2, 0, 0));
    clicks.undo();
    EXPECT_EQ(clicks.pairs().size(), 1u);
    EXPECT_EQ(clicks.on_skin().size(), 2u) << "only the last click was taken back";
    for (int i = 0; i < 5; ++i) clicks.undo();
    EXPECT_TRUE(clicks.on_skin().empty() && clicks.on_scan().empty());
}

TEST(LandmarkClicks, KeepTheNamesOfATableAndNeverUseOneTwice) {
    LandmarkClicks clicks;
    clicks.set_pairs({{"2", {0, 0, 0}, {0, 0, 0}}, {"nasion", {1, 0, 0}, {1, 0, 0}}});
    for (int i = 3; i < 5; ++i) clicks.click_skin({1. * i, 0, 0}), clicks.click_scan({1. * i, 0, 0});
    std::vector<std::string> names;
    for (const PointPair& pair : clicks.pairs()) names.push_back(pair.name);
    EXPECT_EQ(names, (std::vector<std::string>{"2", "nasion", "3", "4"}));
    clicks.set_pairs({{"2", {0, 0, 0}, {0, 0, 0}}});
    clicks.click_skin({1, 0, 0}), clicks.click_scan({1, 0, 0});
    EXPECT_NE(clicks.pairs()[1].name, "2");
}

TEST(LandmarkClicks, MisfitIsThatOfTheBestRigidTransform) {
    LandmarkClicks clicks;
    const RigidTransform turned(Eigen::Translation3d(5, -7, 300) *
                                Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()));
    const std::vector<Vector3d> places{{50, 0, 0}, {-50, 0, 0}, {0, 60, 0}, {0, -60, 0}};
    for (const Vector3d& p : places) clicks.click_skin(p), clicks.click_scan(turned * p);
    EXPECT_NEAR(clicks.misfit_mm(), 0, 1e-9);
    LandmarkClicks off;  // along the axis across the square by turns: nothing rigid makes up for it
    for (std::size_t i = 0; i < 4; ++i)
        off.click_skin(places[i]), off.click_scan(turned * (places[i] + Vector3d(0, 0, i < 2 ? 2 : -2)));
    EXPECT_NEAR(off.misfit_mm(), 2, 0.01);
}

/// A disc on the head as drawn, and what the scene says of its place: (mean pixel of the disc, pixel_of its centre).
std::pair<Eigen::Vector2d, Eigen::Vector2d> drawn_and_said(const Vector3d& p, const SceneView& view) {
    return std::async(
               std::launch::async,
               [&] {
                   const auto context = headless_gl(640, 480);
                   const auto window = render_target(640, 480, 0, [] {});
                   std::pair<Eigen::Vector2d, Eigen::Vector2d> result{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
                   {
                       Scene scene(*window, find_fonts());
                       SceneModel model;
                       model.skin = std::make_shared<TriangleMesh>(test::analytic_head_mesh(4));
                       model.of_scan = true;  // no letters, which are white as well
                       model.markers = std::make_shared<std::vector<SceneMarker>>(
                           std::vector<SceneMarker>{{p, test::analytic_head_normal(p), true}});
                       scene.update(model, view, 640, 480, 1);
                       vtkObject::GlobalWarningDisplayOff();  // GLEW complains without a display
                       window->Render();
                       vtkObject::GlobalWarningDisplayOn();
                       const RgbImage picture = picture_of(*window);
                       double count = 0;
                       for (int y = 0; y < 480; ++y)
                           for (int x = 0; x < 640; ++x) {
                               const Rgb& c = picture.at(x, y);
                               if (c[0] > 235 && c[1] > 235 && c[2] > 235)
                                   result.first += Eigen::Vector2d(x, y), ++count;
                           }
                       result.first /= count;
                       result.second = scene.pixel_of(p);
                       const Ray sight = scene.sight(result.second);
                       EXPECT_LT((p - sight.origin).cross(sight.direction).norm(), 1e-6)
                           << "the sight leads back to the point";
                       EXPECT_GT((p - sight.origin).dot(sight.direction), 0);
                   }
                   window->Finalize();
                   return result;
               })
        .get();
}

TEST(Scene, SaysInWhichPixelItDrewAPoint) {
    unsetenv("DISPLAY");
    for (const SceneView& view : {SceneView{0, 0, 0, 1, {0, 0}}, SceneView{0.5, 0.3, 0, 2, {-15, -10}},
                                  SceneView{-0.4, -0.2, 0, 0.6, {-15, 40}}}) {
        const Vector3d p = test::on_analytic_head({-20, -90, 40});
        const auto [drawn, said] = drawn_and_said(p, view);
        EXPECT_LT((drawn - said).norm(), 3) << "drawn at " << drawn.transpose() << ", said " << said.transpose();
    }
}

/// A scan of the head from the front, in a rig whose left camera stands upside down before the face.
TEST(ClickableScan, StandsAsTheCameraSeesItAndGivesTheRigsPoints) {
    const PointCloud in_ct = test::view_of_analytic_head({0, -600, 0}, 200, 9000, 3);
    CameraModel camera;  // x to the patient's right of the picture, y up: hung upside down
    camera.width = 744, camera.focal_x = 1;
    Eigen::Matrix3d axes;  // rows: right, down, forward of the camera in ct
    axes << -1, 0, 0, 0, 0, 1, 0, 1, 0;
    camera.device_from_rig.linear() = axes;
    const auto scan = clickable_scan(in_ct, &camera);
    ASSERT_NE(scan, nullptr);
    // The nose looks at the viewer; what the camera has at its right (the patient's right, as it hangs) is to the
    // right.
    EXPECT_LT((scan->shown_from_rig.linear() * Vector3d(0, -1, 0) - Vector3d(0, -1, 0)).norm(), 1e-9);
    EXPECT_LT((scan->shown_from_rig.linear() * Vector3d(-1, 0, 0) - Vector3d(1, 0, 0)).norm(), 1e-9);
    EXPECT_LT((scan->shown_from_rig.linear() * Vector3d(0, 0, 1) - Vector3d(0, 0, -1)).norm(), 1e-9);
    // A line of sight on the chin's side meets the true skin.
    const Vector3d looked_at = scan->shown_from_rig * test::on_analytic_head({10, -80, -30});
    const auto hit = scan->surface.first_hit({looked_at + Vector3d(0, -500, 0), Vector3d::UnitY()});
    ASSERT_TRUE(hit.has_value());
    const Vector3d in_rig = scan->shown_from_rig.inverse() * hit->p_in_ct;
    EXPECT_LT((in_rig - test::on_analytic_head(in_rig)).norm(), 0.3);

    const auto alone = clickable_scan(in_ct);  // without a camera: from before the skin, the rig's y downwards
    ASSERT_NE(alone, nullptr);
    Vector3d normal = Vector3d::Zero();
    for (const Vector3d& n : in_ct.normals_in_rig) normal += n;
    EXPECT_GT((alone->shown_from_rig.linear() * -normal.normalized()).y(), 0.99);
    EXPECT_EQ(clickable_scan({}), nullptr);
}

}  // namespace
}  // namespace planlight
