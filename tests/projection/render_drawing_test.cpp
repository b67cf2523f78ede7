#include "projection/render_drawing.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/calib3d.hpp>

#include "projection/stroke_raster.h"
#include "tests/projection/shapes.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double kRadius_mm = 80;
constexpr double kDegree = std::numbers::pi / 180;

/// The eye of the tests: OpenCV's undistortion and a ray on an ideal ball. It shares no code with the renderer.
class CastBack {
public:
    CastBack(const CameraModel& p, const RigidTransform& rig_from_ball)
        : k_((cv::Mat_<double>(3, 3) << p.focal_x, 0, p.centre_x, 0, p.focal_y, p.centre_y, 0, 0, 1)),
          d_((cv::Mat_<double>(1, 5) << p.k1, p.k2, p.p1, p.p2, p.k3)),
          ball_from_device_((p.device_from_rig * rig_from_ball).inverse()) {}

    std::optional<Vector3d> on_ball(const Vector2d& pixel, double radius_mm = kRadius_mm,
                                    const Vector3d& centre = Vector3d::Zero()) const {
        const std::vector<cv::Point2d> in{{pixel.x(), pixel.y()}};
        std::vector<cv::Point2d> out;
        cv::undistortPoints(in, out, k_, d_, cv::noArray(), cv::noArray(),
                            cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-12));
        const Vector3d o = ball_from_device_.translation() - centre;
        const Vector3d d = (ball_from_device_.linear() * Vector3d(out[0].x, out[0].y, 1)).normalized();
        const double b = o.dot(d), c = o.squaredNorm() - radius_mm * radius_mm, root = b * b - c;
        if (root < 0) return std::nullopt;
        return Vector3d(o + (-b - std::sqrt(root)) * d + centre);
    }

private:
    cv::Mat k_, d_;
    RigidTransform ball_from_device_;
};

struct LitPixel {
    Vector2d pixel;
    double share;
    Vector3d on_ball;
};

std::vector<LitPixel> lit_pixels(const RgbImage& picture, const CastBack& eye) {
    std::vector<LitPixel> lit;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const Rgb& c = picture.at(x, y);
            const std::uint8_t value = std::max({c[0], c[1], c[2]});
            if (value == 0) continue;
            const auto p = eye.on_ball({x, y});
            EXPECT_TRUE(p) << "light beside the ball at " << x << " " << y;
            if (p) lit.push_back({{x, y}, test::light_of_number(value), *p});
        }
    return lit;
}

/// A stroke along the circle around `pole` at `angle` from it, from `from` to `to` radians round it.
Stroke arc(const Vector3d& pole, double angle, double from, double to, double width_mm) {
    const Vector3d x = pole.unitOrthogonal(), y = pole.cross(x);
    const int n = static_cast<int>(std::ceil(kRadius_mm * std::sin(angle) * std::abs(to - from) / 0.5));
    Stroke s;
    s.item = 0;
    s.width_mm = width_mm;
    for (int i = 0; i <= n; ++i) {
        const double t = from + (to - from) * i / n;
        const Vector3d normal = std::cos(angle) * pole + std::sin(angle) * (std::cos(t) * x + std::sin(t) * y);
        s.normals_in_ct.push_back(normal);
        s.points_in_ct.push_back(kRadius_mm * normal);
    }
    return s;
}

struct Scene {
    SkinSurface skin{test::ball_mesh(kRadius_mm, 5)};
    RigidTransform rig_from_ct =
        RigidTransform(Eigen::Translation3d(40, -25, 600) * Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()));
    CameraModel projector = test::projector_looking_at({45, -10, 600}, {0.2, -0.3, -1}, 640, {0, -1, 0});
    DrawingRenderer renderer{skin, projector};
    CastBack eye{projector, rig_from_ct};
    /// The ball's normal that points at the projector.
    Vector3d facing() const { return (rig_from_ct.inverse() * projector.centre_in_rig()).normalized(); }

    /// The normal of the place, turned from `facing` about `axis`, where light meets the ball at `slope_deg`.
    Vector3d sloped(double slope_deg, const Vector3d& axis) const {
        const double far_mm = (rig_from_ct.inverse() * projector.centre_in_rig()).norm();
        const double slope = slope_deg * kDegree;  // sine rule in the triangle of light, ball's middle and place
        const double at_light = std::asin(kRadius_mm * std::sin(slope) / far_mm);
        return Eigen::AngleAxisd(slope - at_light, axis) * facing();
    }

    RgbImage render(std::vector<Stroke> strokes) const {
        PlanDrawing drawing;
        drawing.strokes = std::move(strokes);
        return renderer.render(drawing, rig_from_ct);
    }
};

const Scene& scene() {
    static const Scene kScene;
    return kScene;
}

TEST(StrokeRaster, CoverageOfAShapeIsItsAreaAndItsMiddleIsItsMiddle) {
    StrokeRaster raster(40, 30);
    for (const Vector2d& middle : {Vector2d(10, 8), Vector2d(10.3, 7.8), Vector2d(20.77, 15.13)}) {
        for (const double turn : {0.0, 0.4, 1.3}) {
            const Eigen::Rotation2Dd r(turn);
            const Vector2d u = r * Vector2d(6.3, 0), v = r * Vector2d(0, 2.1);
            RgbImage picture(40, 30);
            raster.add_quad({middle - u - v, middle + u - v, middle + u + v, middle - u + v});
            raster.flush({255, 255, 255}, picture);
            double sum = 0;
            Vector2d moment(0, 0);
            for (int y = 0; y < 30; ++y)
                for (int x = 0; x < 40; ++x) {
                    const double light = test::light_of_number(picture.at(x, y)[0]);
                    sum += light;
                    moment += light * Vector2d(x, y);
                }
            EXPECT_NEAR(sum, 4 * 6.3 * 2.1, 0.05);             // 8-bit rounding of about 60 edge pixels
            EXPECT_LT((moment / sum - middle).norm(), 0.015);  // likewise; half a pixel would be 0.5
        }
    }
}

TEST(StrokeRaster, NeighboursLeaveNoSeamAndTheBorderCutsCleanly) {
    StrokeRaster raster(20, 12);
    RgbImage picture(20, 12);
    raster.add_quad({Vector2d(-5, 2.3), Vector2d(7.4, 2.3), Vector2d(9.2, 8.6), Vector2d(-5, 8.6)});
    raster.add_quad({Vector2d(7.4, 2.3), Vector2d(30, 2.3), Vector2d(30, 8.6), Vector2d(9.2, 8.6)});
    raster.flush({200, 100, 0}, picture);
    for (int x = 0; x < 20; ++x)
        for (int y = 0; y < 12; ++y) {
            const double covered = std::clamp(std::min(y + 0.5, 8.6) - std::max(y - 0.5, 2.3), 0.0, 1.0);
            EXPECT_NEAR(test::light_of_number(picture.at(x, y)[0]), covered * test::light_of_number(200), 0.004)
                << x << " " << y;  // 8 bits
        }
}

TEST(RenderDrawing, LightFallsOnTheLineItWasMeantForWithoutBias) {
    // Great circles through the facing point in four directions: what is half a pixel off (0.13 mm) in x or y shows in
    // one.
    for (const double turn : {0.0, 0.8, 1.57, 2.4}) {
        const Vector3d f = scene().facing();
        const Vector3d pole = Eigen::AngleAxisd(turn, f) * f.unitOrthogonal();
        const Vector3d x = pole.unitOrthogonal(), y = pole.cross(x);
        const double middle = std::atan2(f.dot(y), f.dot(x));
        const auto lit =
            lit_pixels(scene().render({arc(pole, std::numbers::pi / 2, middle - 0.5, middle + 0.5, 0.8)}), scene().eye);
        ASSERT_GT(lit.size(), 400u);
        double sum = 0, moment_mm = 0, farthest_mm = 0;
        for (const auto& p : lit) {
            const double off_mm = kRadius_mm * std::asin(p.on_ball.normalized().dot(pole));
            sum += p.share;
            moment_mm += p.share * off_mm;
            farthest_mm = std::max(farthest_mm, std::abs(off_mm));
        }
        const double px_mm = 560.0 / 2450;  // a pixel on the near side of the ball
        EXPECT_LT(std::abs(moment_mm / sum), 0.05 * px_mm) << turn;
        EXPECT_LT(farthest_mm, 0.4 + 0.3);
    }
}

TEST(RenderDrawing, LightFallsTrueInTheCornersOfTheDistortedPicture) {
    // The ball moved to the picture's corners, where the lens bends by up to 30 pixels.
    for (const Vector2d& corner : {Vector2d(250, 250), Vector2d(1650, 250), Vector2d(300, 820), Vector2d(1640, 800)}) {
        const auto ray = ray_through(scene().projector, corner);
        ASSERT_TRUE(ray);
        RigidTransform rig_from_ct = scene().rig_from_ct;
        rig_from_ct.translation() = ray->origin + 700 * ray->direction;
        const CastBack eye(scene().projector, rig_from_ct);
        const Vector3d f = (rig_from_ct.inverse() * scene().projector.centre_in_rig()).normalized();
        for (const double turn : {0.0, 1.57}) {
            const Vector3d pole = Eigen::AngleAxisd(turn, f) * f.unitOrthogonal();
            const Vector3d x = pole.unitOrthogonal(), y = pole.cross(x);
            const double middle = std::atan2(f.dot(y), f.dot(x));
            PlanDrawing drawing;
            drawing.strokes = {arc(pole, std::numbers::pi / 2, middle - 0.3, middle + 0.3, 0.8)};
            double sum = 0, moment_mm = 0;
            for (const auto& p : lit_pixels(scene().renderer.render(drawing, rig_from_ct), eye)) {
                sum += p.share;
                moment_mm += p.share * kRadius_mm * std::asin(p.on_ball.normalized().dot(pole));
            }
            ASSERT_GT(sum, 100);
            EXPECT_LT(std::abs(moment_mm / sum), 0.015);
        }
    }
}

TEST(RenderDrawing, ALineIsAsWideOnASlopeAsInFront) {
    for (const double slope : {0.0, 30.0, 50.0, 65.0}) {
        const Vector3d f = scene().facing();
        const Vector3d pole = f;  // a line of constant slope: the slope squeezes its width, not its length
        const auto picture =
            scene().render({slope > 0 ? arc(pole, slope * kDegree, 0.3, 1.0, 1.6)
                                      : arc(f.unitOrthogonal(), std::numbers::pi / 2, 0, 2 * std::numbers::pi, 1.6)});
        // Light on the skin: each lit pixel's own area on the ball, by its four corners.
        double area_mm2 = 0;
        for (const auto& p : lit_pixels(picture, scene().eye)) {
            const auto a = scene().eye.on_ball(p.pixel + Vector2d(-0.5, -0.5)),
                       b = scene().eye.on_ball(p.pixel + Vector2d(0.5, -0.5));
            const auto c = scene().eye.on_ball(p.pixel + Vector2d(0.5, 0.5)),
                       d = scene().eye.on_ball(p.pixel + Vector2d(-0.5, 0.5));
            ASSERT_TRUE(a && b && c && d);
            area_mm2 += p.share * 0.5 * (*c - *a).cross(*d - *b).norm();
        }
        if (slope == 0) continue;  // the whole circle is only partly lit: no length to divide by
        const double length_mm = kRadius_mm * std::sin(slope * kDegree) * 0.7;
        EXPECT_NEAR(area_mm2 / length_mm, 1.6, 0.05) << slope;
    }
}

TEST(RenderDrawing, ACircleKeepsItsDiameterUpTo65DegreesOfSlope) {
    for (const double slope : {0.0, 25.0, 45.0, 65.0})
        for (const double diameter_mm : {7.0, 14.0}) {
            const Vector3d f = scene().facing();
            const Vector3d n = scene().sloped(slope, f.unitOrthogonal());
            Plan plan;
            plan.boreholes.push_back({"", kRadius_mm * n, {}, diameter_mm, 0, {}});
            DrawingSettings settings;
            settings.labels = false;
            PlanDrawing drawing = draw_plan(plan, scene().skin, settings);
            std::erase_if(drawing.strokes, [](const Stroke& s) { return !s.closed; });
            const auto lit = lit_pixels(scene().renderer.render(drawing, scene().rig_from_ct), scene().eye);
            const Vector3d x = n.unitOrthogonal(), y = n.cross(x);
            std::map<int, std::pair<double, double>>
                by_direction;  // light-weighted distance from the centre, 12 directions
            for (const auto& p : lit) {
                const double far_mm = kRadius_mm * std::acos(std::min(1.0, p.on_ball.normalized().dot(n)));
                const int direction =
                    static_cast<int>(std::floor(std::atan2(p.on_ball.dot(y), p.on_ball.dot(x)) / (30 * kDegree)));
                by_direction[direction].first += p.share;
                by_direction[direction].second += p.share * far_mm;
            }
            double sum_mm = 0;
            ASSERT_EQ(by_direction.size(), 12u);
            for (const auto& [direction, light] : by_direction) {
                const double mean_mm = 2 * light.second / light.first;
                EXPECT_NEAR(mean_mm, diameter_mm, 0.1 + 0.01 * diameter_mm)
                    << slope << " " << direction;  // pixel sampling of one sector
                sum_mm += mean_mm / 12;
            }
            EXPECT_NEAR(sum_mm, diameter_mm, 0.02 * diameter_mm) << slope;
        }
}

TEST(RenderDrawing, TicksAreTenMillimetresApartAsLightUpTo65Degrees) {
    const Vector3d f = scene().facing(), axis = f.unitOrthogonal();
    const auto at = [&](double slope) { return Vector3d(kRadius_mm * scene().sloped(slope, axis)); };
    Plan plan;
    plan.osteotomy_lines.push_back({"", {at(-65), at(65)}, false, {}});
    DrawingSettings settings;
    settings.labels = false;
    const PlanDrawing drawing = draw_plan(plan, scene().skin, settings);
    std::vector<Vector3d> middles;
    for (const Stroke& tick : drawing.strokes) {
        if (tick.kind != StrokeKind::tick) continue;
        PlanDrawing alone;
        alone.strokes = {tick};
        Vector3d sum = Vector3d::Zero();
        for (const auto& p : lit_pixels(scene().renderer.render(alone, scene().rig_from_ct), scene().eye))
            sum += p.share * p.on_ball;
        middles.push_back(sum.normalized());
    }
    ASSERT_GT(middles.size(), 16u);
    for (std::size_t i = 1; i < middles.size(); ++i)
        EXPECT_NEAR(kRadius_mm * std::acos(middles[i].dot(middles[i - 1])), 10, 0.1) << i;
}

TEST(RenderDrawing, SkinInTheShadowOfOtherSkinIsNotLit) {
    // A small ball floats before the large one; no light meant for the large one may fall on it.
    const Vector3d f = scene().facing(), small_centre = 125 * f + 6 * f.unitOrthogonal();
    constexpr double kSmall_mm = 16;
    TriangleMesh mesh = test::ball_mesh(kRadius_mm, 5);
    const TriangleMesh small = test::ball_mesh(kSmall_mm, 4);
    const auto shift = static_cast<std::int32_t>(mesh.vertices_in_ct.size());
    for (const auto& v : small.vertices_in_ct) mesh.vertices_in_ct.push_back(v + small_centre);
    for (const auto& t : small.triangles) mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    const SkinSurface skin(mesh);
    const DrawingRenderer renderer(skin, scene().projector);
    PlanDrawing drawing;
    for (double angle = 0.04; angle < 0.6; angle += 0.04)
        drawing.strokes.push_back(arc(f, angle, 0, 2 * std::numbers::pi, 0.8));
    RgbImage picture;
    const RenderCounts counts = renderer.render_into(picture, drawing, scene().rig_from_ct);
    test::keep_picture(picture, "shadow.png");
    EXPECT_GT(counts.hidden, 200u);
    std::size_t lit = 0, on_small = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            if (picture.at(x, y)[0] < 64) continue;
            ++lit;
            // Half a line's width and half a pixel may lap over the shadow's edge: 0.4 + 0.1 mm.
            on_small += scene().eye.on_ball({x, y}, kSmall_mm - 0.5, small_centre).has_value();
        }
    EXPECT_EQ(on_small, 0u);
    // And the shadow is no larger than it is: every point of the drawing that an ideal ray reaches is lit.
    const Vector3d light = scene().rig_from_ct.inverse() * scene().projector.centre_in_rig();
    std::size_t wrongly_dark = 0;
    for (const Stroke& s : drawing.strokes)
        for (const Vector3d& p : s.points_in_ct) {
            const Vector3d d = (light - p).normalized(), to_centre = small_centre - p;
            if ((to_centre - to_centre.dot(d) * d).norm() < kSmall_mm + 1) continue;
            const auto pixel = project(scene().projector, scene().rig_from_ct * p);
            ASSERT_TRUE(pixel);
            wrongly_dark += picture.at(static_cast<int>(std::lround(pixel->x())),
                                       static_cast<int>(std::lround(pixel->y())))[0] == 0;
        }
    EXPECT_EQ(wrongly_dark, 0u);
    EXPECT_GT(lit, 3000u);
}

TEST(RenderDrawing, TheFarSideAndGrazingSkinStayDark) {
    const Vector3d f = scene().facing();
    const auto dark = [&](const RgbImage& picture) {
        return std::all_of(picture.pixels.begin(), picture.pixels.end(), [](const Rgb& c) {
            return c == Rgb{0, 0, 0};
        });
    };
    EXPECT_TRUE(dark(scene().render({arc(f, 140 * kDegree, 0, 6, 1)})));
    EXPECT_TRUE(dark(scene().render({arc(f, 86 * kDegree, 0, 6, 1)})));
    EXPECT_FALSE(dark(scene().render({arc(f, 60 * kDegree, 0, 6, 1)})));
}

TEST(RenderDrawing, NoLightTouchesAMarker) {
    const Vector3d f = scene().facing();
    PlanDrawing drawing;
    for (double angle = 0.02; angle < 0.5; angle += 0.01)
        drawing.strokes.push_back(arc(f, angle, 0, 2 * std::numbers::pi, 1.2));
    const RigidTransform rig_from_patient(Eigen::Translation3d(3, 4, 5));
    const Vector3d marker_in_rig =
        scene().rig_from_ct * Vector3d(kRadius_mm * (Eigen::AngleAxisd(0.2, f.unitOrthogonal()) * f));
    RenderSettings settings;
    settings.keep_dark_in_patient = {rig_from_patient.inverse() * marker_in_rig};
    const RgbImage picture = scene().renderer.render(drawing, scene().rig_from_ct, rig_from_patient, settings);
    double nearest_mm = 1e9;
    for (const auto& p : lit_pixels(picture, scene().eye))
        nearest_mm = std::min(nearest_mm, (scene().rig_from_ct * p.on_ball - marker_in_rig).norm());
    EXPECT_GT(nearest_mm, 10.2 - 0.2);  // 9 mm and the halo of 1.2 mm, to a pixel
    EXPECT_LT(nearest_mm, 10.2 + 0.6);
    drawing.items.resize(1);
    drawing.items[0].name = "Cut";
    RgbImage again;
    const RenderCounts counts =
        scene().renderer.render_into(again, drawing, scene().rig_from_ct, rig_from_patient, settings);
    EXPECT_GT(counts.on_marker, counts.points / 50) << "and nobody says that it is lit";
    EXPECT_EQ(counts.lit + counts.on_marker + counts.too_steep + counts.hidden + counts.outside, counts.points);
    const auto said = sentences_of_unlit(counts, drawing);
    ASSERT_FALSE(said.empty());
    EXPECT_NE(said.front().find("a marker lies there"), std::string::npos) << said.front();
}

TEST(RenderDrawing, OneItemAloneAndDimmed) {
    const Vector3d f = scene().facing();
    PlanDrawing drawing;
    drawing.strokes = {arc(f, 0.1, 0, 6, 2), arc(f, 0.4, 0, 6, 2)};
    drawing.strokes[1].item = 1;
    RenderSettings settings;
    settings.only_item = 1;
    settings.brightness = 0.5;
    const RgbImage picture =
        scene().renderer.render(drawing, scene().rig_from_ct, RigidTransform::Identity(), settings);
    int brightest = 0;
    for (const auto& p : lit_pixels(picture, scene().eye)) EXPECT_GT(p.on_ball.normalized().dot(f), std::cos(0.45));
    for (const auto& p : lit_pixels(picture, scene().eye)) EXPECT_LT(p.on_ball.normalized().dot(f), std::cos(0.35));
    for (const Rgb& c : picture.pixels) brightest = std::max<int>(brightest, c[0]);
    EXPECT_NEAR(test::light_of_number(static_cast<std::uint8_t>(brightest)), 0.5, 0.005);  // 8 bits
}

}  // namespace
}  // namespace planlight
