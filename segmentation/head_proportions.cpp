#include "segmentation/head_proportions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace planlight {
namespace {

using Eigen::Vector2d;

constexpr double kSlab_mm = 4;

/// In so high a slab, from the ball's axis to the farthest vertex in each direction, mm.
using Outline = std::array<double, 72>;

Vector2d way_of(std::size_t direction) {
    const double turn = (static_cast<double>(direction) + 0.5) / std::tuple_size_v<Outline>;
    const double angle = 2 * std::numbers::pi * (turn - 0.5);
    return {std::cos(angle), std::sin(angle)};
}

/// Empty where a direction has no skin.
std::optional<Outline> outline_at(const TriangleMesh& skin, const HeadBall& ball, double z_mm) {
    Outline radius{};
    for (const Eigen::Vector3d& p : skin.vertices_in_ct) {
        if (std::abs(p.z() - z_mm) > kSlab_mm) continue;
        const Vector2d way = (p - ball.centre_in_ct).head<2>();
        const double turn = std::atan2(way.y(), way.x()) / (2 * std::numbers::pi) + 0.5;
        double& farthest = radius[std::min(radius.size() - 1, static_cast<std::size_t>(turn * double(radius.size())))];
        farthest = std::max(farthest, way.norm());
    }
    if (std::find(radius.begin(), radius.end(), 0.0) != radius.end()) return std::nullopt;
    return radius;
}

/// mm^2; 0 without an outline.
double area_of(const std::optional<Outline>& outline) {
    double area = 0;
    if (outline)
        for (const double r : *outline) area += std::numbers::pi / std::tuple_size_v<Outline> * r * r;
    return area;
}

/// Angle of the outline's principal axis that is nearest to x, from the second moments of its area; -45 to 45 degrees.
double turn_of(const Outline& outline) {
    double area = 0;
    Vector2d middle = Vector2d::Zero();
    Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
    for (std::size_t k = 0; k < outline.size(); ++k) {  // of each narrow triangle to the middle
        const double r = outline[k];
        area += r * r / 2;
        middle += r * r * r / 3 * way_of(k);
        moments += r * r * r * r / 4 * way_of(k) * way_of(k).transpose();
    }
    middle /= area;
    const Eigen::Matrix2d about_middle = moments / area - middle * middle.transpose();
    const double turn = 0.5 * std::atan2(2 * about_middle(0, 1), about_middle(0, 0) - about_middle(1, 1));
    constexpr double kQuarter = std::numbers::pi / 2;
    return turn > kQuarter / 2 ? turn - kQuarter : turn < -kQuarter / 2 ? turn + kQuarter : turn;
}

double extent_mm(const Outline& outline, const Vector2d& along) {
    double low = 0, high = 0;
    for (std::size_t k = 0; k < outline.size(); ++k) {
        const double at = outline[k] * way_of(k).dot(along);
        low = std::min(low, at), high = std::max(high, at);
    }
    return high - low;
}

}  // namespace

std::optional<HeadProportions> head_proportions(const TriangleMesh& skin, const HeadBall& ball) {
    constexpr double kOfArea = 0.8, kStep_mm = 2, kMostLift_mm = 24;
    double level_mm = ball.centre_in_ct.z();
    const auto cut_at = [&](double z_mm) {
        for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v)
            if (skin.flags[v] == kCutPlane && std::abs(skin.vertices_in_ct[v].z() - z_mm) < kSlab_mm) return true;
        return false;
    };
    // A volume that ends below the brow may end at the ball's middle.
    while (cut_at(level_mm)) {
        level_mm += kSlab_mm;
        if (level_mm > ball.centre_in_ct.z() + kMostLift_mm) return std::nullopt;
    }
    Eigen::AlignedBox3d above;
    bool crown_cut = false;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
        const Eigen::Vector3d& p = skin.vertices_in_ct[v];
        if (p.z() <= level_mm) continue;
        crown_cut = crown_cut || skin.flags[v] == kCutPlane;
        above.extend(p);
    }
    const auto outline = outline_at(skin, ball, level_mm);
    if (!outline || above.isEmpty()) return std::nullopt;
    HeadProportions found;
    found.turn = turn_of(*outline);
    const Vector2d across(std::cos(found.turn), std::sin(found.turn));
    found.breadth_mm = extent_mm(*outline, across);
    found.length_mm = extent_mm(*outline, {-across.y(), across.x()});
    found.breadth_of_length = found.breadth_mm / found.length_mm;
    const double area = area_of(outline);
    if (crown_cut) return found;
    for (double z = above.max().z() - kStep_mm; z > level_mm; z -= kStep_mm)
        if (area_of(outline_at(skin, ball, z)) >= kOfArea * area) {
            // An ellipsoid has 0.8 of its largest area at 0.447 of its half height.
            const double half_height_mm = (above.max().z() - z) / (1 - std::sqrt(1 - kOfArea));
            found.height_of_width = half_height_mm / std::sqrt(area / std::numbers::pi);
            break;
        }
    return found;
}

}  // namespace planlight
