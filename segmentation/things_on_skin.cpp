#include "segmentation/things_on_skin.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "planning_io/types/statistics.h"
#include "segmentation/coarse_body.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kGrid_mm = 2;
constexpr double kRolling_mm = 12, kBump_mm = 3;
constexpr double kOneSided_mm = 10, kFar_mm = 40;
constexpr double kAdultSkull_mm = 80, kChin = 1.1;  // of the skull's radius below its middle
constexpr std::size_t kMostPoints = 6000;

/// Signed distances from the body's surface (positive outside), where the volume reaches.
struct Distances {
    CoarseBody coarse;
    std::vector<float> out_mm, in_mm;

    explicit Distances(CoarseBody body) : coarse(std::move(body)) {
        const VoxelGrid& grid = coarse.places.grid;
        out_mm = distance_from(coarse.body, 1, grid, kFar_mm);
        Mask whole = coarse.body;  // an end of the volume is no surface
        for (std::size_t v = 0; v < whole.size(); ++v)
            if (!coarse.places.measured[v]) whole[v] = 1;
        in_mm = distance_from(whole, 0, grid, kFar_mm);
    }
    /// Empty outside the grid.
    std::optional<std::size_t> index_at(const Vector3d& p_in_ct) const {
        const HeadSurvey& places = coarse.places;
        const Eigen::Vector3i at = ((p_in_ct - places.first_in_ct) / places.step_mm()).array().round().cast<int>();
        for (int a = 0; a < 3; ++a)
            if (at[a] < 0 || at[a] >= places.grid.size[static_cast<std::size_t>(a)]) return std::nullopt;
        return places.index(at.x(), at.y(), at.z());
    }
    /// Not a number where nothing was measured.
    double operator()(const Vector3d& p_in_ct) const {
        const auto at = index_at(p_in_ct);
        if (!at) return kFar_mm;
        if (!coarse.places.measured[*at]) return NAN;
        return static_cast<double>(coarse.body[*at] ? -in_mm[*at] : out_mm[*at]);
    }
};

std::vector<double> areas_cm2(const TriangleMesh& skin) {
    std::vector<double> areas(skin.vertices_in_ct.size(), 0);
    for (const auto& t : skin.triangles) {
        const auto at = [&](std::size_t k) { return skin.vertices_in_ct[static_cast<std::size_t>(t[k])]; };
        const double third_cm2 = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 600;
        for (const std::int32_t corner : t) areas[static_cast<std::size_t>(corner)] += third_cm2;
    }
    return areas;
}

bool is_end(const TriangleMesh& skin, std::size_t vertex) {
    return !skin.flags.empty() && skin.flags[vertex] == kCutPlane;
}

/// The plane between left and right: n = (1, yaw, roll) normalised, `aside_mm` from the skull's middle.
struct MiddlePlane {
    Vector3d centre_in_ct;
    double yaw = 0, roll = 0, aside_mm = 0;

    double left_of(const Vector3d& p_in_ct) const {
        return Vector3d(1, yaw, roll).normalized().dot(p_in_ct - centre_in_ct) - aside_mm;
    }
    Vector3d mirrored(const Vector3d& p_in_ct) const {
        return p_in_ct - 2 * left_of(p_in_ct) * Vector3d(1, yaw, roll).normalized();
    }
};

/// Some of the head's skin, to ask its mirror images.
struct Point {
    Vector3d at_in_ct;
    double area_cm2;
};

std::vector<Point> points_of(const TriangleMesh& skin, const HeadBall& ball) {
    const std::vector<double> areas = areas_cm2(skin);
    const double lowest = ball.centre_in_ct.z() - kChin * std::min(ball.radius_mm, kAdultSkull_mm);
    const std::size_t stride = std::max<std::size_t>(1, areas.size() / kMostPoints);
    std::vector<Point> points;
    for (std::size_t v = 0; v < areas.size(); v += stride)
        if (skin.vertices_in_ct[v].z() > lowest && !is_end(skin, v))
            points.push_back({skin.vertices_in_ct[v], areas[v] * static_cast<double>(stride)});
    return points;
}

/// The plane whose mirror images lie best on the surface; from x = 0 of ct, in steps that are halved.
MiddlePlane middle_plane(const Distances& distances, const std::vector<Point>& points, const HeadBall& ball) {
    const auto misfit = [&](const MiddlePlane& plane) {
        double sum = 0, weight = 0;
        for (const Point& p : points) {
            const double off_mm = distances(plane.mirrored(p.at_in_ct));
            if (std::isnan(off_mm)) continue;
            sum += p.area_cm2 * std::pow(std::min(std::abs(off_mm), kOneSided_mm), 2);
            weight += p.area_cm2;
        }
        return weight > 0 ? sum / weight : INFINITY;
    };
    MiddlePlane best{ball.centre_in_ct};
    double least = misfit(best);
    constexpr double kDegree = std::numbers::pi / 180;
    for (double step = 8; step >= 0.5; step /= 2)  // degrees and mm
        for (bool again = true; again;) {
            again = false;
            for (const double by : {-step, step})
                for (int k = 0; k < 3; ++k) {
                    MiddlePlane next = best;
                    (k == 0 ? next.yaw : k == 1 ? next.roll : next.aside_mm) += k < 2 ? by * kDegree : by;
                    if (const double off = misfit(next); off < least) least = off, best = next, again = true;
                }
        }
    return best;
}

double one_sided(const Distances& distances, const std::vector<Point>& points, const MiddlePlane& plane) {
    double cm2 = 0;
    for (const Point& p : points)
        if (distances(plane.mirrored(p.at_in_ct)) > kOneSided_mm) cm2 += p.area_cm2;
    return cm2;
}

double bumps(const Distances& distances, const TriangleMesh& skin, const HeadBall& ball) {
    Mask core(distances.in_mm.size());
    for (std::size_t v = 0; v < core.size(); ++v) core[v] = static_cast<double>(distances.in_mm[v]) > kRolling_mm;
    const auto from_core = distance_from(core, 1, distances.coarse.places.grid, kRolling_mm + kFar_mm);
    const std::vector<double> areas = areas_cm2(skin);
    double cm2 = 0;
    for (std::size_t v = 0; v < areas.size(); ++v) {
        if (is_end(skin, v)) continue;
        const Vector3d away = (skin.vertices_in_ct[v] - ball.centre_in_ct).normalized();
        if (away.z() < 0.2 && (away.z() < -0.15 || away.y() < 0.5)) continue;  // ears, face, neck
        const auto at = distances.index_at(skin.vertices_in_ct[v]);
        if (at && static_cast<double>(from_core[*at]) > kRolling_mm + kBump_mm) cm2 += areas[v];
    }
    return cm2;
}

double width(const TriangleMesh& skin, const MiddlePlane& plane, const HeadBall& ball) {
    double widest = 0;
    for (const double level : {-0.4, -0.6, -0.8}) {
        std::vector<double> aside;
        for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
            const Vector3d& p = skin.vertices_in_ct[v];
            if (is_end(skin, v) || std::abs(p.z() - ball.centre_in_ct.z() - level * ball.radius_mm) > 3) continue;
            aside.push_back(std::abs(plane.left_of(p)));
        }
        if (aside.size() > 30) widest = std::max(widest, quantile(std::move(aside), 0.95) / ball.radius_mm);
    }
    return widest;
}

}  // namespace

ThingsOnSkin things_on_skin(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin,
                            const HeadBall& ball) {
    if (skin.vertices_in_ct.empty() || !(ball.radius_mm > 0)) return {};
    const Distances distances(coarse_body(volume, mask, skin, kGrid_mm, 0));
    const std::vector<Point> points = points_of(skin, ball);
    const MiddlePlane plane = middle_plane(distances, points, ball);
    return {one_sided(distances, points, plane), bumps(distances, skin, ball), width(skin, plane, ball)};
}

}  // namespace planlight
