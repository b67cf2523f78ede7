// The 3-D picture: sides, letters, and what hides what.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <vector>

#include "app/live/scene_of_session.h"
#include "app/windows/distance_colours.h"
#include "app/windows/orientation.h"
#include "app/windows/scene_view.h"
#include "fake_model.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

/// Mean column and row of the pixels for which `like` is true, as fractions of the picture; their count.
template <typename Like>
std::array<double, 3> centre_of(const RgbImage& picture, Like like) {
    double x_sum = 0, y_sum = 0, count = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            if (like(picture.at(x, y))) x_sum += x, y_sum += y, ++count;
    return {x_sum / count / picture.width, y_sum / count / picture.height, count};
}

bool is_plan_green(const Rgb& c) {
    return c[1] > 200 && c[0] < 80 && c[2] < 140;
}

SceneModel head_with_a_green_ring_near(const Eigen::Vector3d& near_in_ct) {
    SceneModel scene;
    scene.skin = std::make_shared<TriangleMesh>(test::analytic_head_mesh(4));
    Stroke ring{StrokeKind::borehole, 0, {40, 235, 110}, 0.8, true, {}, {}};
    const Eigen::Vector3d middle = test::on_analytic_head(near_in_ct),
                          u = test::analytic_head_normal(middle).unitOrthogonal(),
                          v = test::analytic_head_normal(middle).cross(u);
    for (int i = 0; i < 40; ++i) {
        const double a = 2 * M_PI * i / 40;
        ring.points_in_ct.push_back(test::on_analytic_head(middle + 10 * (std::cos(a) * u + std::sin(a) * v)));
        ring.normals_in_ct.push_back(test::analytic_head_normal(ring.points_in_ct.back()));
    }
    scene.plan = std::make_shared<PlanDrawing>(PlanDrawing{{}, {ring}, {}, {}});
    return scene;
}

// No display is needed: the test takes it away.
TEST(RenderScene, ShowsThePatientsRightAtTheViewersLeftWithoutAnyDisplay) {
    unsetenv("DISPLAY");
    const SceneModel scene = head_with_a_green_ring_near({-55, -75, 55});
    const SceneView from_the_front{0, 0, 0, 1, Eigen::Vector2d::Zero()},
        from_behind{M_PI, 0, 0, 1, Eigen::Vector2d::Zero()};
    const auto front = centre_of(render_scene(scene, from_the_front, 640, 480), is_plan_green);
    EXPECT_GT(front[2], 100) << "the ring is seen";
    EXPECT_LT(front[0], 0.45) << "the patient's right is at the viewer's left";
    EXPECT_LT(front[1], 0.5) << "the forehead is in the upper half";
    const auto behind = centre_of(render_scene(scene, from_behind, 640, 480), is_plan_green);
    EXPECT_EQ(behind[2], 0) << "the head hides it from behind";
}

/// How unlike two places of two pictures are, 40 pixels wide, laid on each other as well as they can be: mean grey.
double unlike(const RgbImage& a, const Eigen::Vector2i& at_a, const RgbImage& b, const Eigen::Vector2i& at_b) {
    double least = 1e9;
    for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
            double sum = 0;
            for (int y = -18; y < 18; ++y)
                for (int x = -18; x < 18; ++x)
                    sum +=
                        std::abs(a.at(at_a.x() + x, at_a.y() + y)[1] - b.at(at_b.x() + x + dx, at_b.y() + y + dy)[1]);
            least = std::min(least, sum / (36 * 36));
        }
    return least;
}

TEST(RenderScene, TheLettersStandAtTheSidesOfThePictureTheyName) {
    constexpr int kGap = 29;  // from the edge to the letter's middle at this size
    const Eigen::Vector2i left(kGap, 240), right(640 - kGap, 240), top(320, kGap);
    const std::vector<RgbImage> views =
        render_views({}, {standard_view('A'), standard_view('P'), standard_view('R'), standard_view('L')}, 640, 480);
    const RgbImage &front = views[0], &back = views[1], &from_right = views[2], &from_left = views[3];
    constexpr double kSame = 8, kOther = 20;
    EXPECT_LT(unlike(front, left, back, right), kSame) << "R";
    EXPECT_LT(unlike(front, right, back, left), kSame) << "L";
    EXPECT_LT(unlike(from_right, right, from_left, left), kSame) << "A";
    EXPECT_LT(unlike(from_right, left, from_left, right), kSame) << "P";
    EXPECT_GT(unlike(front, left, front, right), kOther) << "R is not L";
    EXPECT_GT(unlike(front, left, back, left), kOther);
    EXPECT_GT(unlike(from_right, left, from_right, right), kOther) << "P is not A";
    EXPECT_LT(unlike(front, top, back, top), kSame) << "S";
}

// What a letter says is where that side of the patient is seen: a ring on the skin there lies in that half.
TEST(RenderScene, ARingOnASideOfTheHeadLiesAtItsLetterInEveryView) {
    const std::map<char, Eigen::Vector3d> sides{
        {'R', {-1, 0, 0}}, {'L', {1, 0, 0}}, {'A', {0, -1, 0}}, {'P', {0, 1, 0}}, {'S', {0, 0, 1}}};
    for (const auto& [view_letter, towards_viewer] : sides) {
        const SceneView view = standard_view(view_letter);
        for (const auto& [letter, side] : sides) {
            if (std::abs(side.dot(towards_viewer)) > 0.5) continue;
            const SceneModel scene = head_with_a_green_ring_near(75 * side + 90 * towards_viewer);
            const auto ring = centre_of(render_scene(scene, view, 640, 480), is_plan_green);
            if (ring[2] < 50) continue;  // the analytic head hides it
            const ViewAxes axes = axes_of(view);
            const double across = side.dot(axes.right_in_ct), up = side.dot(axes.up_in_ct);
            const double seen = std::abs(across) > 0.5 ? (ring[0] - 0.5) * across : (0.5 - ring[1]) * up;
            EXPECT_GT(seen, 0) << letter << " seen from " << view_letter;
        }
    }
}

// A nerve within the head is looked for from outside; what is judged by its colour on the skin keeps it.
TEST(RenderScene, ARiskStructureIsSeenThroughTheSkinAndUnderThePlan) {
    SceneModel scene = head_with_a_green_ring_near({-55, -75, 55});
    const SceneView view = view_of_plan(*scene.plan);
    const RgbImage bare = render_scene(scene, view, 640, 480);
    scene.risk_structures = std::make_shared<std::vector<RiskStructure>>(
        1, test::risk_structure("Facial nerve", 0.5 * test::on_analytic_head({-55, -75, 55}), 0.3));
    const RgbImage seen = render_scene(scene, view, 640, 480);
    const auto is_blue = [](const Rgb& c) { return c[2] > c[0] + 30 && c[2] > c[1] + 30; };
    EXPECT_EQ(centre_of(bare, is_blue)[2], 0);
    EXPECT_GT(centre_of(seen, is_blue)[2], 3000);
    EXPECT_GT(centre_of(bare, is_plan_green)[2], 100);
    EXPECT_GE(centre_of(seen, is_plan_green)[2], centre_of(bare, is_plan_green)[2]) << "nothing of it is tinted";
    EXPECT_GT(centre_of(render_scene(scene, standard_view('P'), 640, 480), is_blue)[2], 3000) << "from behind as well";
    // Its name stands in the legend, at the lower right.
    double changed = 0;
    for (int y = 380; y < 480; ++y)
        for (int x = 420; x < 640; ++x) changed += seen.at(x, y) != bare.at(x, y);
    EXPECT_GT(changed, 500);
}

TEST(RenderScene, TheCloudDoesNotHideThePlan) {
    SceneModel scene = head_with_a_green_ring_near({-55, -75, 55});
    const SceneView view = view_of_plan(*scene.plan);
    const double bare = centre_of(render_scene(scene, view, 640, 480), is_plan_green)[2];
    auto cloud = std::make_shared<PointCloud>();
    const Eigen::Vector3d middle = test::on_analytic_head({-55, -75, 55}), n = test::analytic_head_normal(middle),
                          u = n.unitOrthogonal(), v = n.cross(u);
    for (double a = -20; a <= 20; a += 0.2)
        for (double b = -20; b <= 20; b += 0.2)
            cloud->points_in_rig.push_back(test::on_analytic_head(middle + a * u + b * v) + 1.5 * n);
    scene.cloud = cloud;
    const double covered = centre_of(render_scene(scene, view, 640, 480), is_plan_green)[2];
    EXPECT_GT(bare, 300);
    EXPECT_GT(covered, 0.9 * bare) << "a cloud that stands 1.5 mm off the skin";
}

TEST(RenderScene, TheItemOfTheMomentIsBrightAndTheOthersDim) {
    SceneModel scene = head_with_a_green_ring_near({-55, -75, 55});
    const SceneView view = view_of_plan(*scene.plan);
    scene.bright_item = 0;
    EXPECT_GT(centre_of(render_scene(scene, view, 640, 480), is_plan_green)[2], 300);
    scene.bright_item = 1;
    EXPECT_EQ(centre_of(render_scene(scene, view, 640, 480), is_plan_green)[2], 0);
}

/// White of a sticker's ring, in a picture from straight before it; letters and all else that is white left out.
double sticker_seen(const SceneModel& scene, const SceneView& view) {
    SceneModel none = scene;
    none.markers = nullptr;
    const auto white = [](const Rgb& c) { return c[0] > 200 && c[1] > 200 && c[2] > 200; };
    return centre_of(render_scene(scene, view, 640, 480), white)[2] -
           centre_of(render_scene(none, view, 640, 480), white)[2];
}

// Nose, brow, the foot of an ear, the nape: where the skin bends, and far from where the head's middle would have it.
TEST(RenderScene, AMarkerLiesWholeOnTheSkinWhereverItIsPasted) {
    SceneModel scene;
    scene.skin = std::make_shared<TriangleMesh>(test::analytic_head_mesh(4));
    const SkinSurface skin(*scene.skin);
    for (const Eigen::Vector3d& near :
         {Eigen::Vector3d(12, -104, -30), Eigen::Vector3d(-30, -90, 10), Eigen::Vector3d(80, -10, -10),
          Eigen::Vector3d(0, -60, 100), Eigen::Vector3d(-40, 95, -20), Eigen::Vector3d(30, -85, -70)}) {
        const SceneMarker marker = marker_on_skin(test::on_analytic_head(near), skin);
        EXPECT_NEAR(marker.normal_in_ct.norm(), 1, 1e-9);
        SceneView view = view_along(marker.normal_in_ct, {0, 0, 1});
        view.zoom = 1;
        const auto shown = [&](double higher_mm) {
            SceneMarker moved = marker;
            moved.p_in_ct += higher_mm * moved.normal_in_ct;
            scene.markers = std::make_shared<std::vector<SceneMarker>>(1, moved);
            return sticker_seen(scene, view);
        };
        const double free = shown(8);
        EXPECT_GT(free, 100);
        EXPECT_GT(shown(0), 0.93 * free) << near.transpose() << ": against one that hovers over the skin";
    }
}

TEST(RenderScene, AnEmptySceneIsDarkButHasItsLetters) {
    const RgbImage picture = render_scene({}, {}, 640, 480);
    ASSERT_EQ(picture.width, 640);
    ASSERT_EQ(picture.height, 480);
    const auto letters_seen = centre_of(picture, [](const Rgb& c) { return c[0] > 200 && c[1] > 200 && c[2] > 200; });
    EXPECT_GT(letters_seen[2], 100);
    EXPECT_LT(letters_seen[2], 5000);
}

/// White pixels near the middle of the picture's width, from so many pixels above its lower edge to so many.
int white_near_middle(const RgbImage& picture, int from, int to) {
    int count = 0;
    for (int y = picture.height - to; y < picture.height - from; ++y)
        for (int x = picture.width / 2 - 16; x <= picture.width / 2 + 16; ++x) {
            const Rgb& c = picture.pixels[static_cast<std::size_t>(y * picture.width + x)];
            count += c[0] > 200 && c[1] > 200 && c[2] > 200;
        }
    return count;
}

TEST(RenderScene, TheLowerLetterStandsAboveALegendThatIsInItsWay) {
    SceneModel scene;
    EXPECT_GT(white_near_middle(render_scene(scene, {}, 640, 480), 0, 60), 50);
    EXPECT_EQ(white_near_middle(render_scene(scene, {}, 640, 480), 72, 140), 0);
    scene.skin_error_mm = std::make_shared<std::vector<float>>();
    EXPECT_GT(white_near_middle(render_scene(scene, {}, 640, 480), 72, 140), 50) << "above 62 pixels of legend";
    EXPECT_EQ(white_near_middle(render_scene(scene, {}, 1920, 1080), 90, 300), 0) << "beside it there is room";
}

/// How many pixels of the picture have about that colour's hue: its largest channel stands out in the same way.
std::size_t pixels_like(const RgbImage& picture, const Rgb& colour) {
    std::size_t count = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const Rgb& p = picture.at(x, y);
            const double scale =
                std::max({p[0], p[1], p[2]}) / static_cast<double>(std::max({colour[0], colour[1], colour[2]}));
            if (scale < 0.25) continue;
            double off = 0;
            for (std::size_t c = 0; c < 3; ++c) off = std::max(off, std::abs(p[c] - scale * colour[c]));
            count += off < 25 * scale + 8;
        }
    return count;
}

TEST(FitViews, ThePredictedErrorIsGreenInFrontAndRedBehindAndHidesTheScan) {
    // The fake match: under 1 mm for the face (y < -60), over 2 mm behind (y > 0).
    const OperatorModel model = test::fake_model();
    const SceneModel error = scene_of_fit(model, FitView::predicted_error);
    EXPECT_EQ(error.cloud, nullptr);
    EXPECT_EQ(error.light, nullptr);
    SceneModel bare;
    bare.skin = error.skin;
    bare.skin_error_mm = error.skin_error_mm;
    const RgbImage front = render_scene(bare, {0, 0}, 640, 480), behind = render_scene(bare, {3.14159, 0}, 640, 480);
    const Rgb green = error_colour(0.5, 1, 2), red = error_colour(3, 1, 2);
    EXPECT_GT(pixels_like(front, green), 10 * pixels_like(front, red) + 5000);
    EXPECT_GT(pixels_like(behind, red), 10 * pixels_like(behind, green) + 5000);
}

TEST(FitViews, BeforeAndAfterShowTheSameScanAtItsTwoPlaces) {
    const OperatorModel model = test::fake_model();
    const SceneModel before = scene_of_fit(model, FitView::before), after = scene_of_fit(model, FitView::after);
    EXPECT_EQ(before.cloud, after.cloud);
    EXPECT_NEAR((before.ct_from_rig.translation() - after.ct_from_rig.translation()).norm(), 4, 1e-9);
    EXPECT_NE(before.cloud_distance_mm, after.cloud_distance_mm);
    OperatorModel without = model;
    without.fit = std::nullopt;
    EXPECT_EQ(scene_of_fit(without, FitView::predicted_error).cloud, model.scene.cloud);
}

TEST(FitViews, APlaceToBeLookedAtStandsOnBareSkin) {
    OperatorModel model = test::fake_model();
    model.look_at = LookAt{{0, -90, 0}, {0, -1, 0}};
    const SceneModel after = scene_of_fit(model, FitView::after);
    EXPECT_EQ(after.cloud, nullptr);
    EXPECT_EQ(after.cloud_distance_mm, nullptr);
    EXPECT_EQ(after.plan, model.scene.plan);
    EXPECT_NE(scene_of_fit(model, FitView::before).cloud, nullptr) << "who asks for the scan sees it";
}

TEST(ViewOfPlan, LooksAtTheSideThePlanIsOn) {
    const auto side = [](const Eigen::Vector3d& near_in_ct) {
        return view_of_plan(*head_with_a_green_ring_near(near_in_ct).plan).azimuth;
    };
    EXPECT_GT(side({-80, 0, 20}), 0.2) << "a plan on the patient's right is looked at from the right";
    EXPECT_LT(side({80, 0, 20}), -0.2);
    EXPECT_NEAR(view_of_plan({}).azimuth, 0, 1e-9) << "no plan: from the front";
}

}  // namespace
}  // namespace planlight
