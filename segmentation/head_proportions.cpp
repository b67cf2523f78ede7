#include "segmentation/head_proportions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace planlight {
namespace {

constexpr double kSlab_mm = 4;

/// Of the outline in so high a slab, by the farthest vertex in each direction from the ball's axis, mm^2; 0 where a
/// direction has none.
double area_at(const TriangleMesh& skin, const HeadBall& ball, double z_mm) {
    constexpr int kWays = 72;
    std::vector<double> radius(kWays, 0);
    for (const Eigen::Vector3d& p : skin.vertices_in_ct) {
        if (std::abs(p.z() - z_mm) > kSlab_mm) continue;
        const Eigen::Vector2d way = (p - ball.centre_in_ct).head<2>();
        const double turn = std::atan2(way.y(), way.x()) / (2 * std::numbers::pi) + 0.5;
        double& farthest = radius[static_cast<std::size_t>(std::min(kWays - 1, static_cast<int>(turn * kWays)))];
        farthest = std::max(farthest, way.norm());
    }
    double area = 0;
    for (const double r : radius) {
        if (r == 0) return 0;
        area += std::numbers::pi / kWays * r * r;
    }
    return area;
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
    Eigen::AlignedBox3d there, above;
    bool crown_cut = false;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
        const Eigen::Vector3d& p = skin.vertices_in_ct[v];
        if (std::abs(p.z() - level_mm) < kSlab_mm) there.extend(p);
        if (p.z() <= level_mm) continue;
        crown_cut = crown_cut || skin.flags[v] == kCutPlane;
        above.extend(p);
    }
    if (there.isEmpty() || above.isEmpty()) return std::nullopt;
    HeadProportions found;
    found.breadth_mm = there.sizes().x();
    found.length_mm = there.sizes().y();
    if (!(found.length_mm > 0)) return std::nullopt;
    found.breadth_of_length = found.breadth_mm / found.length_mm;
    const double area = area_at(skin, ball, level_mm);
    if (crown_cut || area == 0) return found;
    for (double z = above.max().z() - kStep_mm; z > level_mm; z -= kStep_mm)
        if (area_at(skin, ball, z) >= kOfArea * area) {
            // An ellipsoid has 0.8 of its largest area at 0.447 of its half height.
            const double half_height_mm = (above.max().z() - z) / (1 - std::sqrt(1 - kOfArea));
            found.height_of_width = half_height_mm / std::sqrt(area / std::numbers::pi);
            break;
        }
    return found;
}

}  // namespace planlight
