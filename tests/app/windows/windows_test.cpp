#include <gtest/gtest.h>
#include <imgui.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "app/windows/camera_picture.h"
#include "app/windows/distance_colours.h"
#include "app/windows/fonts.h"
#include "app/windows/layout.h"
#include "app/windows/number_text.h"
#include "app/windows/operator_keys.h"
#include "app/windows/orientation.h"
#include "app/windows/panels.h"
#include "app/windows/scene_view.h"
#include "fake_model.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

std::string letters(double azimuth, double elevation) {
    const ViewAxes axes = axes_of({azimuth, elevation, 1, Eigen::Vector2d::Zero()});
    return direction_letters(-axes.right_in_ct) + " " + direction_letters(axes.right_in_ct) + " " +
           direction_letters(axes.up_in_ct) + " " + direction_letters(-axes.up_in_ct);
}

// Left, right, top, bottom of the view; DICOM patient axes: +x left, +y posterior, +z superior.
TEST(Orientation, LettersAreThoseOfThePatientNotOfTheViewer) {
    EXPECT_EQ(letters(0, 0), "R L S I") << "face to face, the patient's right is at the viewer's left";
    EXPECT_EQ(letters(M_PI, 0), "L R S I") << "from behind";
    EXPECT_EQ(letters(M_PI / 2, 0), "P A S I") << "from the patient's right the face looks to the viewer's right";
    EXPECT_EQ(letters(-M_PI / 2, 0), "A P S I") << "from the patient's left";
    EXPECT_EQ(letters(0, 1.5), "R L P A") << "from above, with the face downwards in the picture";
    EXPECT_EQ(letters(M_PI / 4, 0), "RP LA S I") << "half from the right: two letters";
}

TEST(Orientation, TheAxesOfAViewAreRightHanded) {
    for (double az = -3; az < 3; az += 0.37)
        for (double el = -1.5; el < 1.5; el += 0.31) {
            const ViewAxes a = axes_of({az, el, 1, Eigen::Vector2d::Zero()});
            EXPECT_NEAR((a.right_in_ct.cross(a.up_in_ct) - a.backward_in_ct).norm(), 0, 1e-12);
            EXPECT_GT(a.up_in_ct.z(), 0) << "the head is never upside down";
        }
}

TEST(NumberText, HasOneDecimalItsUnitAndNoBlank) {
    EXPECT_EQ(number_text(8.54, "mm"), "8.5 mm");
    EXPECT_EQ(number_text(-0.04, "mm"), "0.0 mm");
    EXPECT_EQ(number_text(1.24, "°"), "1.2°");
    EXPECT_EQ(number_text(std::nullopt, "mm"), "–");
    EXPECT_EQ(number_text(std::numeric_limits<double>::quiet_NaN(), "mm"), "–");
    EXPECT_EQ(number_text(-std::numeric_limits<double>::infinity(), "mm"), "–");
}

/// The fonts as the windows load them, without any window.
struct LoadedFonts {
    ImFontAtlas atlas;
    FontSet fonts;
    explicit LoadedFonts(const FontFiles& files, float scale = 1) : fonts(load_fonts(atlas, files, scale)) {}
};

// A planning station once showed "8_.5 mm": a digit replaced by a blank (FDA class I recall). Every number, every size.
TEST(Fonts, NoCharacterOfAnyNumberIsBlank) {
    const LoadedFonts loaded(find_fonts());
    const FontSet& f = loaded.fonts;
    for (const ImFont* font : {f.small, f.body, f.strong, f.number, f.title})
        for (int tenths = -9999; tenths <= 9999; ++tenths)
            ASSERT_TRUE(missing_glyphs(*font, number_text(tenths / 10.0, "mm")).empty()) << tenths / 10.0;
}

TEST(Fonts, EveryShownCharacterExistsInEverySize) {
    const std::string shown =
        "0123456789 .,:;-–—·°µ⌀±×≤≥≈…/()%+−√²³äöüÄÖÜßéèçñøåŁłšžΔσαβμДЖ "
        "The plan on the skin may be used. Overlay error now / s ABCDEFGHIJKLMNOPQRSTUVWXYZ abcdefghijklmnopqrstuvwxyz";
    for (const float scale : {0.6F, 1.0F, 1.5F}) {
        const LoadedFonts loaded(find_fonts(), scale);
        const FontSet& f = loaded.fonts;
        for (const ImFont* font : {f.small, f.body, f.strong, f.number, f.title})
            EXPECT_EQ(missing_glyphs(*font, shown), std::vector<std::string>{});
        for (const StatusKind kind : {StatusKind::ready, StatusKind::scanning, StatusKind::matching,
                                      StatusKind::aligned, StatusKind::check, StatusKind::refused, StatusKind::dark})
            EXPECT_TRUE(missing_glyphs(*f.word, status_word(kind)).empty()) << status_word(kind);
        EXPECT_EQ(missing_glyphs(*f.body, "a漢b"), std::vector<std::string>{"漢"}) << "what is missing is found out";
    }
}

TEST(Fonts, DejaVuAloneIsEnough) {
    const std::filesystem::path folder = "/usr/share/fonts/truetype/dejavu";
    if (!std::filesystem::exists(folder / "DejaVuSans.ttf")) GTEST_SKIP() << "fonts-dejavu-core is not installed";
    const LoadedFonts loaded({folder / "DejaVuSans.ttf", folder / "DejaVuSans-Bold.ttf", {}});
    EXPECT_TRUE(missing_glyphs(*loaded.fonts.body, "Borehole 1, ⌀ 7.0 mm · 1.2° – µ …").empty());
}

// 20 mm on a 24 inch screen of 1080 lines (299 mm high) are 72 pixels.
TEST(Fonts, TheStatusWordIsReadableAtFourMetres) {
    const LoadedFonts loaded(find_fonts());
    const ImFontGlyph* const letter = loaded.fonts.word->FindGlyphNoFallback('A');
    ASSERT_NE(letter, nullptr);
    EXPECT_GE(letter->Y1 - letter->Y0, 72);
}

bool overlap(const Box& a, const Box& b) {
    return a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
}

TEST(Layout, NothingOverlapsOrLeavesTheWindowAtAnySize) {
    for (int width = 1280; width <= 3840; width += 64)
        for (int height = 720; height <= 2160; height += 48) {
            const WindowLayout p = layout_of(width, height);
            const std::vector<Box> all{p.title,        p.steps, p.dark,    p.scene, p.left_camera,
                                       p.right_camera, p.table, p.buttons, p.banner};
            for (std::size_t i = 0; i < all.size(); ++i) {
                EXPECT_GE(all[i].x, 0);
                EXPECT_GE(all[i].y, 0);
                EXPECT_LE(all[i].right(), width);
                EXPECT_LE(all[i].bottom(), height);
                EXPECT_GE(all[i].width, 72) << i << " at " << width << "x" << height;
                EXPECT_GE(all[i].height, 72) << i << " at " << width << "x" << height;
                for (std::size_t j = 0; j < i; ++j)
                    EXPECT_FALSE(overlap(all[i], all[j])) << i << " and " << j << " at " << width << "x" << height;
            }
            EXPECT_GE((p.buttons.width - 3 * p.gap) / 4, 72);
        }
}

TEST(CameraPicture, IsShrunkToTheMeanOfItsPixels) {
    GrayImage picture(5, 4, 0);
    picture.at(0, 0) = 40;
    picture.at(1, 1) = 20;
    picture.at(4, 0) = 255;  // left over at the edge
    const GrayImage small = shrunk(picture, 2);
    EXPECT_EQ(small.width, 2);
    EXPECT_EQ(small.height, 2);
    EXPECT_EQ(small.at(0, 0), 15);
    EXPECT_EQ(small.at(1, 0), 0);
}

TEST(CameraPicture, IsBrightenedUntilItsBrightestAreWhiteButNoiseStaysDark) {
    GrayImage dim(100, 100, 10);
    for (int x = 0; x < 100; ++x) dim.at(x, 0) = 50;  // one per cent
    EXPECT_EQ(brightened(dim).at(0, 0), 255);
    EXPECT_EQ(brightened(dim).at(0, 1), 51);
    GrayImage noise(100, 100, 0);
    for (int x = 0; x < 100; ++x) noise.at(x, x) = 2;
    EXPECT_LE(brightened(noise).at(0, 0), 32) << "at most 16 times brighter";
}

TEST(OperatorKeys, EveryMeaningHasAKeyThatIsShownAndDarkHasFour) {
    for (int meaning = 1; meaning <= static_cast<int>(KeyMeaning::stay); ++meaning)
        EXPECT_NE(key_text(static_cast<KeyMeaning>(meaning)), "") << meaning;
    EXPECT_EQ(key_text(KeyMeaning::dark), "Space · B · Esc · PgUp");
    EXPECT_EQ(meaning_of(' '), KeyMeaning::dark);
    EXPECT_EQ(meaning_of('Z'), KeyMeaning::none);
}

// What is drawn is decided by this comparison: a model that differs anywhere must not be taken for the former one.
TEST(OperatorModelComparison, NoticesWhatAPersonWouldSee) {
    const OperatorModel model;
    const auto differs = [&](auto change) {
        OperatorModel other = model;
        change(other);
        return !(other == model);
    };
    EXPECT_TRUE(model == OperatorModel(model));
    EXPECT_TRUE(differs([](auto& m) { m.status.headline = "x"; }));
    EXPECT_TRUE(differs([](auto& m) { m.status.share = 0.5; }));
    EXPECT_TRUE(differs([](auto& m) { m.left.old_s = 3; }));
    EXPECT_TRUE(differs([](auto& m) { m.right.live.picture = std::make_shared<GrayImage>(2, 2); }));
    EXPECT_TRUE(differs([](auto& m) { m.figures.overlay_error_mm = 0.1; }));
    EXPECT_TRUE(differs([](auto& m) { m.scene.light = std::make_shared<std::vector<LightLine>>(); }));
    EXPECT_TRUE(differs([](auto& m) { m.scene.ct_from_rig.translation().x() = 1e-9; }));
    EXPECT_TRUE(differs([](auto& m) { m.fit.emplace(); }));
    EXPECT_TRUE(differs([](auto& m) { m.stop.enabled = true; }));
    EXPECT_TRUE(differs([](auto& m) { m.rows.emplace_back(); }));
}

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
    scene.plan = std::make_shared<PlanDrawing>(PlanDrawing{{}, {ring}, {}});
    return scene;
}

// No display is needed: the test takes it away.
TEST(RenderScene, ShowsThePatientsRightAtTheViewersLeftWithoutAnyDisplay) {
    unsetenv("DISPLAY");
    const SceneModel scene = head_with_a_green_ring_near({-55, -75, 55});
    const SceneView from_the_front{0, 0, 1, Eigen::Vector2d::Zero()}, from_behind{M_PI, 0, 1, Eigen::Vector2d::Zero()};
    const auto front = centre_of(render_scene(scene, from_the_front, 640, 480), is_plan_green);
    EXPECT_GT(front[2], 100) << "the ring is seen";
    EXPECT_LT(front[0], 0.45) << "the patient's right is at the viewer's left";
    EXPECT_LT(front[1], 0.5) << "the forehead is in the upper half";
    const auto behind = centre_of(render_scene(scene, from_behind, 640, 480), is_plan_green);
    EXPECT_EQ(behind[2], 0) << "the head hides it from behind";
}

TEST(RenderScene, AnEmptySceneIsDarkButHasItsLetters) {
    const RgbImage picture = render_scene({}, {}, 640, 480);
    ASSERT_EQ(picture.width, 640);
    ASSERT_EQ(picture.height, 480);
    const auto letters_seen = centre_of(picture, [](const Rgb& c) { return c[0] > 200 && c[1] > 200 && c[2] > 200; });
    EXPECT_GT(letters_seen[2], 100);
    EXPECT_LT(letters_seen[2], 5000);
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
