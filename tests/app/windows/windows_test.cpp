#include <gtest/gtest.h>
#include <imgui.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
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
    const ViewAxes axes = axes_of({azimuth, elevation, 0, 1, Eigen::Vector2d::Zero()});
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

std::string letters(const SceneView& view) {
    const ViewAxes axes = axes_of(view);
    return direction_letters(-axes.right_in_ct) + " " + direction_letters(axes.right_in_ct) + " " +
           direction_letters(axes.up_in_ct) + " " + direction_letters(-axes.up_in_ct);
}

TEST(Orientation, TheStandardViewsHaveTheLettersOfTheirSides) {
    EXPECT_EQ(letters(standard_view('A')), "R L S I");
    EXPECT_EQ(letters(standard_view('P')), "L R S I");
    EXPECT_EQ(letters(standard_view('R')), "P A S I") << "from the patient's right the face looks to the right";
    EXPECT_EQ(letters(standard_view('L')), "A P S I");
    EXPECT_EQ(letters(standard_view('S')), "R L P A");
}

// The patient lies on the back. Who stands at the head has the patient's right hand at the right, and the feet above.
TEST(Orientation, TheSurgeonSeesThePatientAsFromThere) {
    const auto seen = [](const Eigen::Vector3d& away) {
        const ViewAxes axes = axes_of(surgeon_view(away));
        return direction_letters(axes.right_in_ct).substr(0, 1) + direction_letters(axes.up_in_ct).substr(0, 1) +
               direction_letters(axes.backward_in_ct).substr(0, 1);
    };
    EXPECT_EQ(seen({0, 0, 1}), "LSA") << "from the feet, as face to face";
    EXPECT_EQ(seen({0, 0, -1}), "RIA") << "from the head";
    EXPECT_EQ(seen({-1, 0, 0}), "SRA") << "from the left side: the head at the right hand, the right ear away";
    EXPECT_EQ(seen({1, 0, 0}), "ILA") << "from the right side";
}

TEST(Orientation, AViewAlongADirectionHasItAndItsUpright) {
    for (const Eigen::Vector3d& backward : {Eigen::Vector3d(0.3, -0.8, 0.2), Eigen::Vector3d(0, 0, 1),
                                            Eigen::Vector3d(-1, 0.1, -0.4), Eigen::Vector3d(0, 1, 0)})
        for (const Eigen::Vector3d& up : {Eigen::Vector3d(0.1, 0.2, -1), Eigen::Vector3d(1, 0.3, 0.1)}) {
            const ViewAxes axes = axes_of(view_along(backward, up));
            const Eigen::Vector3d b = backward.normalized();
            EXPECT_NEAR((axes.backward_in_ct - b).norm(), 0, 1e-9);
            EXPECT_NEAR(axes.up_in_ct.dot((up - up.dot(b) * b).normalized()), 1, 1e-9);
            EXPECT_NEAR((axes.right_in_ct.cross(axes.up_in_ct) - axes.backward_in_ct).norm(), 0, 1e-9);
        }
}

TEST(Orientation, TheAxesOfAViewAreRightHanded) {
    for (double az = -3; az < 3; az += 0.37)
        for (double el = -1.5; el < 1.5; el += 0.31) {
            const ViewAxes a = axes_of({az, el, 0, 1, Eigen::Vector2d::Zero()});
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

// The patient's name, or the words of a language that the site added.
TEST(Fonts, LettersOfOtherScriptsComeFromOtherFontsOfTheComputer) {
    if (!std::filesystem::exists("/usr/share/fonts/truetype/wqy/wqy-microhei.ttc"))
        GTEST_SKIP() << "no fonts-wqy-microhei";
    ImFontAtlas atlas;
    const FontSet fonts = load_fonts(atlas, find_fonts(), 1, {"患者王小明", "准备"});
    for (const ImFont* font : {fonts.small, fonts.body, fonts.strong, fonts.number, fonts.title})
        EXPECT_EQ(missing_glyphs(*font, "患者: 王小明, 8.5 mm"), std::vector<std::string>{});
    EXPECT_EQ(missing_glyphs(*fonts.word, "准备"), std::vector<std::string>{});
}

// "B3 left sphenoid ... ⌀7  6 mm deep": the figures at the end are what is read from the row.
TEST(Fonts, ALongNameIsShortenedInTheMiddleAndKeepsItsFigures) {
    const LoadedFonts loaded(find_fonts());
    const ImFont* const font = loaded.fonts.body;
    const std::string name = "Bohrloch für die Schraube am linken Keilbeinflügel  ⌀7  6 mm deep";
    for (const float width : {160.0F, 240.0F, 400.0F}) {
        const std::string shown = shortened_in_the_middle(font, name, width);
        EXPECT_LE(text_width(font, shown), width);
        EXPECT_GT(text_width(font, shown), width - 40) << "no more than it takes";
        EXPECT_TRUE(shown.starts_with("Bohr")) << shown;
        EXPECT_TRUE(shown.ends_with("deep")) << shown;
        EXPECT_NE(shown.find("…"), std::string::npos) << shown;
    }
    EXPECT_EQ(shortened_in_the_middle(font, "B3", 160), "B3");
    EXPECT_EQ(shortened_in_the_middle(font, name, 3), "…");
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
