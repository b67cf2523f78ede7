#include "registration/scan/movement/scan_movement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "registration/scan/check/camera_gamma.h"
#include "registration/scan/check/picture_noise.h"

namespace planlight {
namespace {

/// An affine map (6) and how much brighter the projector is than in the first picture (1).
using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

constexpr std::size_t kLeastPixels = 2000;

/// Pixels at which a movement would show: lit, not saturated, off the border; with the first picture's slope there.
struct Template {
    struct Pixel {
        int x, y;
        float dx, dy, light;  ///< slope; white less black
    };
    std::vector<Pixel> pixels;
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    double scale = 1;  ///< half the size of what is lit, pixels
    Eigen::LDLT<Matrix7d> normal;
    bool determined = false;
};

/// The derivative of a pixel's grey value by the numbers of a map about the centre.
Vector7d by_map(const Template& t, const Template::Pixel& p) {
    const double u = (p.x - t.centre.x()) / t.scale, v = (p.y - t.centre.y()) / t.scale;
    Vector7d J;
    J << p.dx, p.dx * u, p.dx * v, p.dy, p.dy * u, p.dy * v, -p.light;
    return J;
}

/// A 3 x 3 mean, so that noise does not pass for slope.
std::vector<float> softened(const std::vector<float>& picture, int width, int height) {
    std::vector<float> soft(picture.size(), 0);
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    for (int y = 1; y + 1 < height; ++y)
        for (int x = 1; x + 1 < width; ++x) {
            float sum = 0;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) sum += picture[at(x + dx, y + dy)];
            soft[at(x, y)] = sum / 9;
        }
    return soft;
}

/// White less black, 255 for all that a camera can show.
std::vector<float> light_of_projector(const std::vector<GrayImage>& frames, double gamma) {
    std::vector<float> light = even_light_picture(frames, {"white", 0, {0}}, gamma);  // twice the light, as of a pair
    const std::vector<float> black = even_light_picture(frames, {"black", 0, {1}}, gamma);
    for (std::size_t i = 0; i < light.size(); ++i) light[i] = (light[i] - black[i]) / 2;
    return light;
}

/// `light`: white less black, in proportion to light also where the camera's grey values are not.
Template make_template(const std::vector<float>& first, const std::vector<float>& light, const GrayImage& white,
                       const GrayImage& black) {
    constexpr int kSaturated = 250;
    constexpr float kLeastLight_grey = 12;
    const double noise_grey = 5 * noise_in_dark(white, black);
    constexpr float kSteepest = 60;  // grey a pixel (of twice the grey values): an edge of the head, not its skin
    Template t;
    const int width = white.width;
    const auto lit = [&](std::size_t i) {
        return light[i] > kLeastLight_grey && white.pixels[i] > black.pixels[i] + noise_grey &&
               white.pixels[i] < kSaturated;
    };
    Eigen::Array2d sum = Eigen::Array2d::Zero(), squares = sum;
    for (int y = 4; y + 4 < white.height; ++y)
        for (int x = 4; x + 4 < width; ++x) {
            const std::size_t i = white.index(x, y);
            if (!lit(i) || !lit(white.index(x - 4, y)) || !lit(white.index(x + 4, y)) || !lit(white.index(x, y - 4)) ||
                !lit(white.index(x, y + 4)))
                continue;
            const float dx = 0.5F * (first[i + 1] - first[i - 1]),
                        dy = 0.5F *
                             (first[i + static_cast<std::size_t>(width)] - first[i - static_cast<std::size_t>(width)]);
            if (std::hypot(dx, dy) > kSteepest) continue;
            t.pixels.push_back({x, y, dx, dy, light[i]});
            sum += Eigen::Array2d(x, y);
            squares += Eigen::Array2d(x, y).square();
        }
    if (t.pixels.size() < kLeastPixels) return t;
    const auto n = static_cast<double>(t.pixels.size());
    t.centre = sum / n;
    t.scale = std::max(1.0, std::sqrt((squares / n - (sum / n).square()).sum()));
    Matrix7d A = Matrix7d::Zero();
    for (const auto& p : t.pixels) A += by_map(t, p) * by_map(t, p).transpose();
    t.normal.compute(A);
    t.determined = t.normal.vectorD().minCoeff() > 1e-9 * t.normal.vectorD().maxCoeff();
    return t;
}

/// The map that lays a later picture on the first, as the numbers of `by_map`.
Vector7d laid_on(const Template& t, const std::vector<float>& first, const std::vector<float>& later, int width) {
    Vector7d map = Vector7d::Zero();
    for (const double huber_grey :
         {1e9, 24.0, 12.0}) {  // what does not fit a map (an edge, a hand) is given less and less weight
        Vector7d b = Vector7d::Zero();
        for (const auto& p : t.pixels) {
            const std::size_t i =
                static_cast<std::size_t>(p.y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(p.x);
            const Vector7d J = by_map(t, p);
            const double r = static_cast<double>(first[i]) - static_cast<double>(later[i]) - J.dot(map);
            b += J * std::clamp(r, -huber_grey, huber_grey);
        }
        map += t.normal.solve(b);
    }
    return map;
}

/// How far most of the lit skin (95 %) lies apart under two maps, pixels.
double way_px(const Template& t, const Vector7d& a, const Vector7d& b) {
    const Vector7d d = a - b;
    std::vector<double> ways;
    for (std::size_t k = 0; k < t.pixels.size(); k += 1 + t.pixels.size() / 500) {
        const double u = (t.pixels[k].x - t.centre.x()) / t.scale, v = (t.pixels[k].y - t.centre.y()) / t.scale;
        ways.push_back(std::hypot(d(0) + d(1) * u + d(2) * v, d(3) + d(4) * u + d(5) * v));
    }
    const auto at = ways.begin() + static_cast<std::ptrdiff_t>(ways.size() * 95 / 100);
    std::nth_element(ways.begin(), at, ways.end());
    return *at;
}

}  // namespace

ScanMovement movement_in_pictures(const ScanCapture& capture, double mm_per_px) {
    ScanMovement movement;
    const auto moments = uniform_light_frames(capture);
    if (moments.size() < 3 || moments.front().name != "white") return movement;
    const GrayImage& white = capture.left[0];
    const double gamma = camera_gamma(capture.left, moments);
    const auto even = [&](const UniformLightFrame& moment) {
        return softened(even_light_picture(capture.left, moment, gamma), white.width, white.height);
    };
    const auto first = even(moments.front());
    const Template t = make_template(first, light_of_projector(capture.left, gamma), white, capture.left[1]);
    if (!t.determined) return movement;
    movement.by = ScanMovement::By::pictures;
    movement.camera_gamma = gamma;
    movement.moments = static_cast<int>(moments.size());
    std::vector<Vector7d> maps;
    for (const auto& moment : moments) maps.push_back(laid_on(t, first, even(moment), white.width));
    for (std::size_t i = 0; i < maps.size(); ++i)
        for (std::size_t j = i + 1; j < maps.size(); ++j) {
            const double moved_mm = mm_per_px * way_px(t, maps[i], maps[j]);
            if (moved_mm <= movement.moved_mm) continue;
            movement.moved_mm = moved_mm;
            movement.from = moments[i].name;
            movement.to = moments[j].name;
        }
    return movement;
}

double mm_per_left_pixel(const PointCloud& cloud, const CameraModel& left_camera) {
    std::vector<double> depths;
    for (const auto& p : cloud.points_in_rig) depths.push_back((left_camera.device_from_rig * p).z());
    if (depths.empty()) return 0;
    const auto middle = median(depths);
    return middle / left_camera.focal_x;
}

}  // namespace planlight
