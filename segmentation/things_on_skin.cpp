#include "segmentation/things_on_skin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "planning_io/types/statistics.h"
#include "segmentation/coarse_body.h"
#include "segmentation/distance_transform.h"
#include "segmentation/triangle_area.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kGrid_mm = 2;
constexpr double kRolling_mm = 12, kBump_mm = 3;
constexpr double kOneSided_mm = 10, kFar_mm = 40;
constexpr double kLargestSkull_mm = 80;  // radius of an adult's
constexpr double kChin = 1.1;            // of the skull's radius below its middle
constexpr double kLeastMirrored = 0.5;   // of the skin: whose mirror image the volume shows
constexpr double kShelfBehind = 0.35, kShelfFrom = 0.25, kShelfTo = 1.4, kLooksUp = 0.5;  // radii; of the normal
constexpr std::size_t kMostPoints = 6000;

/// Signed distances from the body's surface (positive outside), where the volume reaches.
struct Distances {
    CoarseBody coarse;
    Eigen::Affine3d voxel_from_ct, cell_from_ct;  ///< of the volume, of the grid
    std::array<int, 3> size;                      ///< of the volume
    std::vector<float> out_mm, in_mm;

    Distances(CoarseBody body, const Volume& volume)
        : coarse(std::move(body)), voxel_from_ct(volume.ct_from_voxel.inverse()), size(volume.size) {
        const VoxelGrid& grid = coarse.places.grid;
        cell_from_ct = Eigen::Scaling(1 / coarse.places.step_mm()) * Eigen::Translation3d(-coarse.places.first_in_ct);
        out_mm = distance_from(coarse.body, 1, grid, kFar_mm);
        Mask whole = coarse.body;  // an end of the volume is no surface
        for (std::size_t v = 0; v < whole.size(); ++v)
            if (!coarse.places.measured[v]) whole[v] = 1;
        in_mm = distance_from(whole, 0, grid, kFar_mm);
    }
    /// Empty outside the grid.
    std::optional<std::size_t> index_at(const Vector3d& p_in_ct) const { return index_of(cell_from_ct * p_in_ct); }
    std::optional<std::size_t> index_of(const Vector3d& cell) const {
        const auto& cells = coarse.places.grid.size;
        for (int a = 0; a < 3; ++a)
            if (!(cell[a] >= -0.5 && cell[a] < cells[static_cast<std::size_t>(a)] - 0.5)) return std::nullopt;
        const Eigen::Vector3i at = (cell.array() + 0.5).cast<int>();  // the nearest: nothing is negative here
        return coarse.places.index(at.x(), at.y(), at.z());
    }
    bool is_measured(const Vector3d& p_in_ct) const {
        const Vector3d at = voxel_from_ct * p_in_ct;
        for (int a = 0; a < 3; ++a)
            if (!(at[a] >= -0.5 && at[a] < size[static_cast<std::size_t>(a)] - 0.5)) return false;
        return true;
    }
    /// Not a number where nothing was measured. The grid is the skin's box: beyond it lies air, or the volume's end.
    double operator()(const Vector3d& p_in_ct) const {
        return at_cell(cell_from_ct * p_in_ct, [&] { return p_in_ct; });
    }
    /// The same by the place in the grid's voxels; `place_in_ct()` gives it in ct where it lies outside.
    template <class Place>
    double at_cell(const Vector3d& cell, const Place& place_in_ct) const {
        const auto at = index_of(cell);
        if (!at) return is_measured(place_in_ct()) ? kFar_mm : NAN;
        if (!coarse.places.measured[*at]) return NAN;
        return static_cast<double>(coarse.body[*at] ? -in_mm[*at] : out_mm[*at]);
    }
};

std::vector<double> areas_cm2(const TriangleMesh& skin) {
    std::vector<double> areas(skin.vertices_in_ct.size(), 0);
    for (const auto& t : skin.triangles) {
        const double third_cm2 = area_in_ct(skin, t).norm() / 300;
        for (const std::int32_t corner : t) areas[static_cast<std::size_t>(corner)] += third_cm2;
    }
    return areas;
}

bool is_end(const TriangleMesh& skin, std::size_t vertex) {
    return !skin.flags.empty() && skin.flags[vertex] == kCutPlane;
}

/// Some of the head's skin, to ask its mirror images.
struct Point {
    Vector3d at_in_ct;
    double area_cm2;
};

std::vector<Point> points_of(const TriangleMesh& skin, const HeadBall& ball) {
    const std::vector<double> areas = areas_cm2(skin);
    const double lowest = ball.centre_in_ct.z() - kChin * std::min(ball.radius_mm, kLargestSkull_mm);
    const std::size_t stride = std::max<std::size_t>(1, areas.size() / kMostPoints);
    std::vector<Point> points;
    for (std::size_t v = 0; v < areas.size(); v += stride)
        if (skin.vertices_in_ct[v].z() > lowest && !is_end(skin, v))
            points.push_back({skin.vertices_in_ct[v], areas[v] * static_cast<double>(stride)});
    return points;
}

constexpr double kDegree = std::numbers::pi / 180;

/// From that plane to the nearest of least `misfit`, in steps that are halved; gives its misfit.
template <class Misfit>
double descend(const Misfit& misfit, MiddlePlane& plane) {
    double least = misfit(plane, INFINITY);
    for (double step = 8; step >= 0.5; step /= 2)  // degrees and mm
        for (bool again = true; again;) {
            again = false;
            for (const double by : {-step, step})
                for (int k = 0; k < 3; ++k) {
                    MiddlePlane next = plane;
                    (k == 0 ? next.yaw : k == 1 ? next.roll : next.aside_mm) += k < 2 ? by * kDegree : by;
                    if (const double off = misfit(next, least); off < least) least = off, plane = next, again = true;
                }
        }
    return least;
}

/// The plane whose mirror images lie best on the surface: sought from x = 0 of ct, and where a head may look aside,
/// from planes that are turned; one of these must mirror clearly better.
MiddlePlane middle_plane(const Distances& distances, const std::vector<Point>& points, const HeadBall& ball) {
    constexpr double kClearly = 0.7;
    const double all =
        std::accumulate(points.begin(), points.end(), 0.0, [](double sum, const Point& p) { return sum + p.area_cm2; });
    // Beyond `worst` it is enough to know that it is worse.
    const auto misfit = [&](const MiddlePlane& plane, double worst) -> double {
        const Eigen::Affine3d mirror = plane.mirror_in_ct();
        const Eigen::Affine3d cell_of_image = distances.cell_from_ct * mirror;
        double sum = 0, weight = 0;
        for (const Point& p : points) {
            const double off_mm = distances.at_cell(cell_of_image * p.at_in_ct, [&] { return mirror * p.at_in_ct; });
            if (std::isnan(off_mm)) continue;
            sum += p.area_cm2 * std::pow(std::min(std::abs(off_mm), kOneSided_mm), 2);
            weight += p.area_cm2;
            if (sum > worst * all) return INFINITY;
        }
        return weight > kLeastMirrored * all ? sum / weight : INFINITY;  // not the plane that mirrors next to nothing
    };
    MiddlePlane best{ball.centre_in_ct};
    double least = descend(misfit, best);
    for (const double turned : {-35.0, 35.0, -60.0, 60.0}) {
        MiddlePlane plane{ball.centre_in_ct};
        plane.yaw = std::tan(turned * kDegree);
        if (const double off = descend(misfit, plane); off < kClearly * least) best = plane, least = off;
    }
    return best;
}

double one_sided(const Distances& distances, const std::vector<Point>& points, const MiddlePlane& plane) {
    const Eigen::Affine3d mirror = plane.mirror_in_ct();
    double cm2 = 0, mirrored = 0, all = 0;
    for (const Point& p : points) {
        all += p.area_cm2;
        const double off_mm = distances(mirror * p.at_in_ct);
        if (std::isnan(off_mm)) continue;
        mirrored += p.area_cm2;
        if (off_mm > kOneSided_mm) cm2 += p.area_cm2;
    }
    return mirrored > kLeastMirrored * all ? cm2 : NAN;
}

double bumps(const Distances& distances, const TriangleMesh& skin, const HeadBall& ball) {
    Mask core(distances.in_mm.size());
    for (std::size_t v = 0; v < core.size(); ++v) core[v] = static_cast<double>(distances.in_mm[v]) > kRolling_mm;
    const auto from_core = distance_from(core, 1, distances.coarse.places.grid, kRolling_mm + kFar_mm);
    const std::vector<double> areas = areas_cm2(skin);
    double cm2 = 0, all = 0;
    for (std::size_t v = 0; v < areas.size(); ++v) {
        if (is_end(skin, v)) continue;
        const Vector3d away = (skin.vertices_in_ct[v] - ball.centre_in_ct).normalized();
        if (away.z() < 0.2 && (away.z() < -0.15 || away.y() < 0.5)) continue;  // ears, face, neck
        all += areas[v];
        const auto at = distances.index_at(skin.vertices_in_ct[v]);
        if (at && static_cast<double>(from_core[*at]) > kRolling_mm + kBump_mm) cm2 += areas[v];
    }
    return all > 0 ? cm2 : NAN;
}

double width(const TriangleMesh& skin, const MiddlePlane& plane, const HeadBall& ball) {
    double widest = NAN;
    for (const double level : {-0.4, -0.6, -0.8}) {
        std::vector<double> aside;
        for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
            const Vector3d& p = skin.vertices_in_ct[v];
            if (is_end(skin, v) || std::abs(p.z() - ball.centre_in_ct.z() - level * ball.radius_mm) > 3) continue;
            aside.push_back(std::abs(plane.left_of(p)));
        }
        if (aside.size() > 30) widest = std::fmax(widest, quantile(std::move(aside), 0.95) / ball.radius_mm);
    }
    return widest;
}

double shelf(const TriangleMesh& skin, const HeadBall& ball) {
    const double r = std::min(ball.radius_mm, kLargestSkull_mm);
    double up_cm2 = 0, all = 0;
    for (const auto& t : skin.triangles) {
        const Vector3d from = skin.vertices_in_ct[static_cast<std::size_t>(t[0])] - ball.centre_in_ct;
        if (from.y() < kShelfBehind * r || from.z() > -kShelfFrom * r || from.z() < -kShelfTo * r) continue;
        if (std::any_of(t.begin(), t.end(), [&](auto c) { return is_end(skin, static_cast<std::size_t>(c)); }))
            continue;
        const Vector3d area = area_in_ct(skin, t);
        all += area.norm() / 100;
        if (area.z() > kLooksUp * area.norm()) up_cm2 += area.norm() / 100;
    }
    return all > 0 ? up_cm2 : NAN;
}

}  // namespace

ThingsOnSkin things_on_skin(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin,
                            const HeadBall& ball) {
    if (skin.vertices_in_ct.empty() || !(ball.radius_mm > 0)) return {};
    const Distances distances(coarse_body(volume, mask, skin, kGrid_mm, 0), volume);
    const std::vector<Point> points = points_of(skin, ball);
    const MiddlePlane plane = middle_plane(distances, points, ball);
    return {one_sided(distances, points, plane), bumps(distances, skin, ball), width(skin, plane, ball),
            shelf(skin, ball), plane};
}

}  // namespace planlight
