// Light across one stretch of stroke, in pictures drawn here.
#include <gtest/gtest.h>

#include <cmath>

#include "projection/find_light.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kPx_per_mm = 4;

CameraModel straight_above() {
    CameraModel camera;
    camera.width = camera.height = 200;
    camera.focal_x = camera.focal_y = kPx_per_mm * 500;
    camera.centre_x = camera.centre_y = 100;
    return camera;  // looks along z; the skin lies 500 mm before it
}

/// Along y, through the middle of the picture, 1 mm wide.
StrokeSegment stroke() {
    StrokeSegment segment;
    segment.item = 0;
    segment.search_mm = 3;
    for (double y = -2.5; y < 2.6; y += 0.5)
        segment.places.push_back({{0, y, 500}, -Vector3d::UnitZ(), Vector3d::UnitY(), Vector3d::UnitX(), 1.0, true});
    return segment;
}

/// Skin of grey 60, with lines along y of that grey more or less at these places.
struct Line {
    double at_mm, grey, sigma_mm;
};
GrayImage picture_of(const std::vector<Line>& lines) {
    GrayImage picture(200, 200, 60);
    for (int x = 0; x < 200; ++x) {
        double grey = 60;
        for (const Line& line : lines) {
            const double e = ((x - 100) / kPx_per_mm - line.at_mm) / line.sigma_mm;
            grey += line.grey * std::exp(-e * e / 2);
        }
        for (int y = 0; y < 200; ++y) picture.at(x, y) = static_cast<std::uint8_t>(std::lround(grey));
    }
    return picture;
}

CameraLook look_at(const std::vector<Line>& lines) {
    return find_light(stroke(), straight_above(), RigidTransform::Identity(), picture_of(lines), {});
}

TEST(FindLight, ALineOfLightIsFoundWhereItLies) {
    for (const double off_mm : {-1.7, -0.3, 0.0, 0.4, 1.5}) {
        const CameraLook look = look_at({{off_mm, 70, 0.35}});
        ASSERT_TRUE(look.asked && look.light) << off_mm;
        EXPECT_NEAR(look.light->off_mm, off_mm, 0.05);
    }
    EXPECT_FALSE(look_at({}).light);
}

// Where a surgeon has drawn over the light with a pen: beside the dark line nothing bright lies.
TEST(FindLight, InkOnTheSkinIsNotTakenForLightBesideIt) {
    for (const double ink : {-10.0, -20.0, -45.0})
        for (const double at_mm : {0.0, 0.5}) {
            const CameraLook look = look_at({{at_mm, ink, 0.5}});
            EXPECT_TRUE(look.asked);
            EXPECT_FALSE(look.light) << ink << " at " << at_mm << ": " << look.light->off_mm;
        }
    const CameraLook beside = look_at({{0, 70, 0.35}, {1.8, -30, 0.2}});
    ASSERT_TRUE(beside.light) << "a hair beside the light";
    EXPECT_NEAR(beside.light->off_mm, 0, 0.1);
}

}  // namespace
}  // namespace planlight
