#include "tests/registration/scan/footprint_figures.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <optional>
#include <unordered_map>

namespace planlight::scan_rooms {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using simulation::SimulatedRig;

constexpr int kReach = 4, kSide = 2 * kReach + 1;
using Window = std::array<double, kSide * kSide>;

/// Weight of a pixel in the value at the centre of a quadric fitted over (2 reach + 1) squared pixels; 1 for reach 0.
double quadric_weight(int x, int y, int reach) {
    if (reach == 0) return 1;
    const double side = 2 * reach + 1, mean = reach * (reach + 1) / 3.0;  // of x^2
    double squares = 0;                                                   // of x^2 - mean, over all pixels
    for (int u = -reach; u <= reach; ++u) squares += side * (u * u - mean) * (u * u - mean);
    return 1 / (side * side) - mean * (x * x + y * y - 2 * mean) / squares;
}

/// Weights of the 9 x 9 pixels that sum to one: the lens's Gaussian, then that fit.
Window window_of(int reach) {
    constexpr double kLens_px = 0.7;
    Window weights{};
    double sum = 0;
    for (int y = -kReach; y <= kReach; ++y)
        for (int x = -kReach; x <= kReach; ++x) {
            double& w = weights[static_cast<std::size_t>((y + kReach) * kSide + x + kReach)];
            for (int v = -reach; v <= reach; ++v)
                for (int u = -reach; u <= reach; ++u)
                    w += quadric_weight(u, v, reach) *
                         std::exp(-0.5 * ((x - u) * (x - u) + (y - v) * (y - v)) / (kLens_px * kLens_px));
            sum += w;
        }
    for (double& w : weights) w /= sum;
    return weights;
}

/// The lit true skin behind every pixel of the left camera that is asked for, in rig.
class Skin {
public:
    Skin(const SimulatedRig& room, const CameraModel& left, Instant at)
        : room_(room),
          rig_from_ct_(room.true_rig_from_ct(at)),
          at_(at),
          width_(left.width),
          height_(left.height),
          wanted_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)),
          points_(wanted_.size()) {}

    /// False: the window round the pixel is not in the picture.
    bool want(const Eigen::Vector2i& pixel) {
        if (pixel.minCoeff() < kReach || pixel.x() >= width_ - kReach || pixel.y() >= height_ - kReach) return false;
        for (int k = 0; k < kSide * kSide; ++k) wanted_[index(pixel, k)] = 1;
        return true;
    }
    void look() {
        tbb::parallel_for(0, height_, [&](int y) {
            for (int x = 0; x < width_; ++x) {
                const std::size_t i =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
                if (!wanted_[i]) continue;
                const auto sight = room_.true_sight(SimulatedRig::Camera::left, Vector2d(x, y), at_);
                if (sight && sight->lit_by) points_[i] = rig_from_ct_ * sight->p_in_ct;
            }
        });
    }
    const std::optional<Vector3d>& at(const Eigen::Vector2i& pixel, int place) const {
        return points_[index(pixel, place)];
    }

private:
    std::size_t index(const Eigen::Vector2i& pixel, int place) const {
        return static_cast<std::size_t>(pixel.y() + place / kSide - kReach) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(pixel.x() + place % kSide - kReach);
    }
    const SimulatedRig& room_;
    RigidTransform rig_from_ct_;
    Instant at_;
    int width_, height_;
    std::vector<char> wanted_;
    std::vector<std::optional<Vector3d>> points_;
};

std::optional<Eigen::Vector2i> pixel_of(const CameraModel& camera, const Vector3d& p_in_rig) {
    const auto pixel = project(camera, p_in_rig);
    if (!pixel || !in_picture(camera, *pixel)) return std::nullopt;
    return Eigen::Vector2i((pixel->array() + 0.5).floor().cast<int>());
}

/// Heights of the true skin over the point along its normal, in the 9 x 9 pixels; empty at an edge.
std::optional<Window> heights_over(const Skin& skin, const Eigen::Vector2i& pixel, const Vector3d& p,
                                   const Vector3d& normal) {
    constexpr double kEdge_mm = 8;  // farther from the point is other skin: 9 pixels are 4 mm on it
    Window heights;
    for (int k = 0; k < kSide * kSide; ++k) {
        const auto& there = skin.at(pixel, k);
        if (!there || (*there - p).norm() > kEdge_mm) return std::nullopt;
        heights[static_cast<std::size_t>(k)] = normal.dot(*there - p);
    }
    return heights;
}

double off(const Window& weights, const Window& heights) {
    double sum = 0;
    for (std::size_t k = 0; k < heights.size(); ++k) sum -= weights[k] * heights[k];
    return sum;
}

/// The points of a scan that both cameras see, by the left pixel they were made for.
std::unordered_map<int, Vector3d> by_left_pixel(const ScanResult& scan, const CameraModel& left) {
    std::unordered_map<int, Vector3d> points;
    for (std::size_t i = 0; i < scan.raw.cloud.size(); ++i) {
        if (scan.raw.seen[i] != Triangulation::Seen::both) continue;
        const auto pixel = pixel_of(left, scan.raw.cloud.points_in_rig[i]);
        if (pixel) points[pixel->y() * left.width + pixel->x()] = scan.raw.cloud.points_in_rig[i];
    }
    return points;
}

}  // namespace

FootprintFigures footprint_figures(const ScanResult& scan, const ScanResult& again, const SimulatedRig& room,
                                   const RigCalibration& rig, Instant at) {
    constexpr double kOther_mm = 1;  // a point of the other scan farther away is no repetition of this one
    const PointCloud& cloud = scan.clean.kept;
    const std::vector<bool> facing = facing_points(cloud, room, rig, at);
    Skin skin(room, rig.left_camera, at);
    std::vector<std::pair<std::size_t, Eigen::Vector2i>> chosen;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const auto pixel = pixel_of(rig.left_camera, cloud.points_in_rig[i]);
        if (facing[i] && pixel && skin.want(*pixel)) chosen.emplace_back(i, *pixel);
    }
    skin.look();
    const auto second = by_left_pixel(again, rig.left_camera);
    const Window lens = window_of(0), window = window_of(2);
    std::vector<Vector3d> points;
    std::vector<double> at_point, by_lens, by_window;
    FootprintFigures figures;
    double squares = 0;
    for (const auto& [i, pixel] : chosen) {
        const Vector3d &p = cloud.points_in_rig[i], &normal = cloud.normals_in_rig[i];
        const auto heights = heights_over(skin, pixel, p, normal);
        if (!heights) continue;
        points.push_back(p);
        at_point.push_back(-(*heights)[kSide * kReach + kReach]);
        by_lens.push_back(off(lens, *heights));
        by_window.push_back(off(window, *heights));
        const auto other = second.find(pixel.y() * rig.left_camera.width + pixel.x());
        if (other == second.end() || (other->second - p).norm() > kOther_mm) continue;
        squares += std::pow(normal.dot(other->second - p), 2) / 2;
        ++figures.repeated;
    }
    figures.points = points.size();
    figures.at_point_mm = scatter_in_cubes_mm(points, at_point);
    figures.by_lens_mm = scatter_in_cubes_mm(points, by_lens);
    figures.by_window_mm = scatter_in_cubes_mm(points, by_window);
    figures.repeat_mm = std::sqrt(squares / std::max<double>(1, static_cast<double>(figures.repeated)));
    return figures;
}

}  // namespace planlight::scan_rooms
