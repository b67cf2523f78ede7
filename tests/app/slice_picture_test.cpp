#include "app/report/slice_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/report/preparation_pictures.h"
#include "app/report/thresholds_picture.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

/// 100 mm of air (-1000) with a ball of 3 mm of 1000 HU at `ball_in_ct`. Voxels of 2 mm, centred on the origin; a slice
/// stack sheared by `shear` mm of y a mm of z, as under a tilted gantry.
Volume air_with_a_ball(const Vector3d& ball_in_ct, double shear = 0) {
    Volume v;
    v.size = {51, 51, 51};
    v.is_hu = true;
    v.ct_from_voxel.linear() = 2 * Eigen::Matrix3d::Identity();
    v.ct_from_voxel.linear()(1, 2) = 2 * shear;
    v.ct_from_voxel.translation() = Vector3d(-50, -50 - 50 * shear, -50);
    v.values.assign(51 * 51 * 51, -1000);
    for (int k = 0; k < 51; ++k)
        for (int j = 0; j < 51; ++j)
            for (int i = 0; i < 51; ++i)
                if ((v.ct_from_voxel * Vector3d(i, j, k) - ball_in_ct).norm() < 3) v.values[v.index(i, j, k)] = 1000;
    return v;
}

/// Where the picture is white, relative to its middle, in half pictures (x to the right, y down); letters are
/// off-white.
Eigen::Vector2d white_place(const RgbImage& picture) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int count = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            if (picture.at(x, y) == Rgb{255, 255, 255}) {
                sum += Eigen::Vector2d(x, y);
                ++count;
            }
    EXPECT_GT(count, 20);
    return (sum / count - Eigen::Vector2d(picture.width - 1, picture.height - 1) / 2) / (0.5 * picture.width);
}

TEST(SlicePicture, SidesAreThoseOfRadiology) {
    // In ct (LPS) the ball lies to the left, in front and above. 30 mm of a half picture of 53 mm.
    const Vector3d ball(30, -20, 10);
    const Volume volume = air_with_a_ball(ball);
    const auto axial = white_place(slice_picture(volume, {}, {}, SliceKind::axial, ball));
    EXPECT_NEAR(axial.x(), 30 / 53.0, 0.01) << "left is on the right of the picture";
    EXPECT_NEAR(axial.y(), -20 / 53.0, 0.01) << "anterior is up";
    const auto coronal = white_place(slice_picture(volume, {}, {}, SliceKind::coronal, ball));
    EXPECT_NEAR(coronal.x(), 30 / 53.0, 0.01);
    EXPECT_NEAR(coronal.y(), -10 / 53.0, 0.01) << "superior is up";
    const auto sagittal = white_place(slice_picture(volume, {}, {}, SliceKind::sagittal, ball));
    EXPECT_NEAR(sagittal.x(), -20 / 53.0, 0.01) << "anterior is on the left, seen from the patient's left";
    EXPECT_NEAR(sagittal.y(), -10 / 53.0, 0.01);
}

TEST(SlicePicture, ATiltedStackStandsAsThePatientDoes) {
    // The box of a stack sheared by 0.3 is 130 mm wide in y: 1.06 * 130 / 2 = 68.9 mm a half picture.
    const Vector3d ball(0, -20, 30);
    const auto sagittal = white_place(slice_picture(air_with_a_ball(ball, 0.3), {}, {}, SliceKind::sagittal, ball));
    EXPECT_NEAR(sagittal.x(), -20 / 68.9, 0.01);
    EXPECT_NEAR(sagittal.y(), -30 / 68.9, 0.01);
}

TEST(SlicePicture, SkinLineLiesWhereThePlaneCutsTheMesh) {
    // A cone of radius 40 at z = 0 and 0 at z = 40 (its tip towards the head): at z = 15 the plane cuts a circle of 25
    // mm.
    TriangleMesh cone;
    constexpr int kSides = 720;
    for (int i = 0; i < kSides; ++i) {
        const double a = 2 * std::numbers::pi * i / kSides;
        cone.vertices_in_ct.emplace_back(40 * std::cos(a), 40 * std::sin(a), 0);
        cone.triangles.push_back({i, (i + 1) % kSides, kSides});
    }
    cone.vertices_in_ct.emplace_back(0, 0, 40);
    const RgbImage picture = slice_picture(air_with_a_ball({0, 0, -45}), cone, {}, SliceKind::axial, {0, 0, 15});
    const double mm_per_px = 106.0 / picture.width;
    int on_line = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const Rgb& p = picture.at(x, y);
            if (p[1] < 150 || p[0] > 120) continue;  // green
            const double r = mm_per_px * std::hypot(x - 319.5, y - 319.5);
            EXPECT_NEAR(r, 25, 3 * mm_per_px);
            ++on_line;
        }
    EXPECT_GT(on_line, 2 * std::numbers::pi * 25 / mm_per_px) << "the whole circle is there";
}

/// Rows and columns of the picture that are pink, as the plan is: their number, mm.
Eigen::Vector2d extent_of_plan(const RgbImage& picture, double mm_per_px) {
    int left = picture.width, right = -1, top = picture.height, bottom = -1;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            if (picture.at(x, y) == Rgb{255, 92, 160}) {
                left = std::min(left, x), right = std::max(right, x);
                top = std::min(top, y), bottom = std::max(bottom, y);
            }
    return right < 0 ? Eigen::Vector2d::Zero()
                     : Eigen::Vector2d(mm_per_px * Eigen::Vector2d(right - left, bottom - top));
}

TEST(SlicePicture, HolesAndCutPlanesAreOnIt) {
    TriangleMesh wall;  // skin that faces forwards, -y
    wall.vertices_in_ct = {{-3, -20, -3}, {3, -20, -3}, {3, -20, 3}, {-3, -20, 3}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    Plan holes;
    holes.boreholes.push_back({"H", {0, -20, 0}, Vector3d(0, 1, 0), 7, 12, std::nullopt});
    const Volume volume = air_with_a_ball({0, 0, -45});
    const double mm_per_px = 106.0 / slice_picture(volume, {}, {}, SliceKind::axial, {0, 0, 0}).width;
    const auto hole = extent_of_plan(slice_picture(volume, wall, holes, SliceKind::axial, {0, 0, 0}), mm_per_px);
    EXPECT_NEAR(hole.x(), 7, 0.6) << "as wide as it is planned";
    EXPECT_NEAR(hole.y(), 12, 0.6) << "and as deep";
    EXPECT_EQ(extent_of_plan(slice_picture(volume, wall, holes, SliceKind::axial, {0, 0, 20}), mm_per_px).norm(), 0);

    Case without_axis;  // square to the skin then
    without_axis.skin = wall;
    without_axis.plan = holes;
    without_axis.plan.boreholes[0].axis_in_ct.reset();
    PreparationPictures pictures;
    add_slices(volume, without_axis, pictures);
    ASSERT_EQ(pictures.plan_slices.size(), 3u);
    EXPECT_NEAR((extent_of_plan(pictures.plan_slices[0].picture, mm_per_px) - hole).norm(), 0, 0.6);

    Plan cut;
    cut.cut_planes.push_back({"C", {0, 0, 0}, {0, 1, 0}, {1, 0, 0}, 30, 20, std::nullopt});
    const auto plane = extent_of_plan(slice_picture(volume, wall, cut, SliceKind::axial, {0, 0, 5}), mm_per_px);
    EXPECT_NEAR(plane.x(), 30, 1);
    EXPECT_LT(plane.y(), 1);
    EXPECT_NEAR(extent_of_plan(slice_picture(volume, wall, cut, SliceKind::sagittal, {3, 0, 0}), mm_per_px).y(), 20, 1);
}

TEST(SlicePicture, OutsideTheVolumeIsNotBlackTissue) {
    const RgbImage picture = slice_picture(air_with_a_ball({0, 0, 0}), {}, {}, SliceKind::axial, {0, 0, 200});
    EXPECT_EQ(picture.at(320, 320), (Rgb{10, 14, 26})) << "beyond the last slice there is nothing to show";
}

/// Pixels of the middle row of `row`-th tile of `column` between the outermost ones of the skin's line.
int width_of_line(const RgbImage& sheet, int column, int row) {
    const int tile = sheet.width / 3, y = sheet.height - 3 * tile + row * tile + tile / 2;
    int first = -1, last = -1;
    for (int x = column * tile + 50; x < (column + 1) * tile - 50; ++x) {
        const Rgb p = sheet.at(x, y);
        if (p[1] < p[0] + 60 || p[1] < p[2] + 60) continue;  // the skin's line is green
        if (first < 0) first = x;
        last = x;
    }
    return last - first;
}

TEST(ThresholdsPicture, ShowsTheSkinAtThreeThresholdsSideBySide) {
    // A ball whose values fall from 1000 at 30 mm of its middle to 0 at 46 mm.
    Volume ball = air_with_a_ball(Vector3d::Zero());
    ball.is_hu = false;
    for (int k = 0; k < 51; ++k)
        for (int j = 0; j < 51; ++j)
            for (int i = 0; i < 51; ++i)
                ball.values[ball.index(i, j, k)] = static_cast<float>(
                    std::clamp((46 - (ball.ct_from_voxel * Vector3d(i, j, k)).norm()) / 16, 0.0, 1.0) * 1000);
    SkinSettings settings;
    settings.threshold = 500;
    const RgbImage sheet = thresholds_picture(ball, settings, 500);
    for (int row = 0; row < 3; ++row) {
        const double mm_per_pixel = 2 * 38.0 / width_of_line(sheet, 1, row);  // 500: radius 38 mm
        EXPECT_NEAR(width_of_line(sheet, 0, row) * mm_per_pixel, 2 * 40.4, 1.5) << row;
        EXPECT_NEAR(width_of_line(sheet, 2, row) * mm_per_pixel, 2 * 34.0, 1.5) << row;
    }
}

}  // namespace
}  // namespace planlight::test
