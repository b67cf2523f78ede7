// Layout, keys, orientation letters and camera pictures of the windows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "app/windows/camera_picture.h"
#include "app/windows/layout.h"
#include "app/windows/number_text.h"
#include "app/windows/operator_keys.h"
#include "app/windows/operator_model.h"
#include "app/windows/orientation.h"
#include "app/windows/page_input.h"

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

TEST(NumberText, AnErrorOverALimitDoesNotReadAsTheLimit) {
    EXPECT_EQ(error_text(1.0, "", {1, 2}), "1.0");
    EXPECT_EQ(error_text(1.001, "mm", {1, 2}), "1.1 mm");
    EXPECT_EQ(error_text(1.2, "", {1, 2}), "1.2");
    EXPECT_EQ(error_text(-2.03, "", {1, 2}), "-2.1");
    EXPECT_EQ(error_text(std::nullopt, "", {1, 2}), "–");
}

bool overlap(const Box& a, const Box& b) {
    return a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
}

void expect_in_place(int width, int height) {
    const WindowLayout p = layout_of(width, height);
    const float least = 71.9F * shrinking(width, height);
    const std::vector<Box> all{p.title,        p.steps, p.dark,    p.scene, p.left_camera,
                               p.right_camera, p.table, p.buttons, p.banner};
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_GE(all[i].x, 0);
        EXPECT_GE(all[i].y, 0);
        EXPECT_LE(all[i].right(), static_cast<float>(width) + 0.01F);
        EXPECT_LE(all[i].bottom(), static_cast<float>(height) + 0.01F);
        EXPECT_GE(all[i].width, least) << i << " at " << width << "x" << height;
        EXPECT_GE(all[i].height, least) << i << " at " << width << "x" << height;
        for (std::size_t j = 0; j < i; ++j)
            EXPECT_FALSE(overlap(all[i], all[j])) << i << " and " << j << " at " << width << "x" << height;
    }
    EXPECT_GE((p.buttons.width - 3 * p.gap) / 4, least);
    // Over the 3-D view: four buttons in its corner end below those at its top, and beside those of the views.
    const Box corner = corner_button(p.scene, p.scale), fit = fit_row(p.scene, p.scale);
    EXPECT_GE((fit.width - 24 * p.scale) / 4, least) << width << "x" << height;
    EXPECT_LT(corner.right(), fit.x) << width << "x" << height;
    EXPECT_GT(corner.bottom() - 4 * corner.height - 36 * p.scale, fit.bottom()) << width << "x" << height;
}

TEST(Layout, NothingOverlapsOrLeavesTheWindowAtAnySize) {
    for (int width = 800; width <= 3840; width += 32)
        for (int height = 600; height <= std::min(2160, width); height += 48) expect_in_place(width, height);
}

TEST(Layout, NorOnAScreenThatStandsOnEnd) {
    for (int height = 800; height <= 3840; height += 32)
        for (int width = 600; width <= std::min(2160, height - 1); width += 48) expect_in_place(width, height);
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
// A window that was busy hears both at once: no light may follow darkness.
TEST(PageInput, DarkForgetsWhatWasPressedBesideIt) {
    for (const bool dark_first : {false, true}) {
        PageInput<KeyMeaning> input;
        if (dark_first) input.press(KeyMeaning::dark);
        input.press(KeyMeaning::scan);
        if (!dark_first) input.press(KeyMeaning::dark);
        EXPECT_TRUE(input.take_dark());
        EXPECT_FALSE(input.waits());
        EXPECT_EQ(input.take(), KeyMeaning::none);
        EXPECT_FALSE(input.take_dark()) << "once";
    }
}

TEST(PageInput, APressIsTakenOnce) {
    PageInput<KeyMeaning> input;
    input.press(KeyMeaning::track);
    input.press(KeyMeaning::none);
    EXPECT_FALSE(input.take_dark());
    EXPECT_TRUE(input.waits());
    EXPECT_EQ(input.take(), KeyMeaning::track);
    EXPECT_FALSE(input.waits());
}

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

}  // namespace
}  // namespace planlight
