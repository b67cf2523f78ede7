#include "registration/scan/clean/surface_triangles.h"
#include "planning_io/types/statistics.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace planlight {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertices>>;
using Triangle = std::array<std::int32_t, 3>;

bool has_normals(const PointCloud& cloud) {
    return cloud.normals_in_rig.size() == cloud.size();
}

/// Where each finite point lies in a picture of the surface.
std::vector<std::pair<Kernel::Point_2, std::int32_t>> flattened(const PointCloud& cloud) {
    std::vector<std::pair<Kernel::Point_2, std::int32_t>> flat;
    const bool by_pixels = cloud.pixels_in_projector.size() == cloud.size();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    if (!by_pixels) {
        if (!has_normals(cloud)) return flat;
        for (const Eigen::Vector3d& n : cloud.normals_in_rig)
            if (n.allFinite()) normal += n;
        if (normal.norm() < 1e-9) return flat;
        normal.normalize();
    }
    const Eigen::Vector3d u = by_pixels ? Eigen::Vector3d::UnitX() : normal.unitOrthogonal(), v = normal.cross(u);
    flat.reserve(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const Eigen::Vector3d& p = cloud.points_in_rig[i];
        const Eigen::Vector2d at = by_pixels ? cloud.pixels_in_projector[i] : Eigen::Vector2d(u.dot(p), v.dot(p));
        if (p.allFinite() && at.allFinite())
            flat.emplace_back(Kernel::Point_2(at.x(), at.y()), static_cast<std::int32_t>(i));
    }
    return flat;
}

double longest_side_mm(const PointCloud& cloud, const Triangle& t) {
    const auto at = [&](int corner) -> const Eigen::Vector3d& {
        return cloud.points_in_rig[static_cast<std::size_t>(t[static_cast<std::size_t>(corner)])];
    };
    return std::max({(at(0) - at(1)).norm(), (at(1) - at(2)).norm(), (at(2) - at(0)).norm()});
}

/// How far the triangles' own normals look along the points' normals, all together.
double agreement(const PointCloud& cloud, const std::vector<Triangle>& triangles) {
    double sum = 0;
    for (const Triangle& t : triangles) {
        const auto a = static_cast<std::size_t>(t[0]), b = static_cast<std::size_t>(t[1]),
                   c = static_cast<std::size_t>(t[2]);
        const auto& p = cloud.points_in_rig;
        const Eigen::Vector3d normal = cloud.normals_in_rig[a] + cloud.normals_in_rig[b] + cloud.normals_in_rig[c];
        const double part = (p[b] - p[a]).cross(p[c] - p[a]).dot(normal);
        if (std::isfinite(part)) sum += part;
    }
    return sum;
}

}  // namespace

std::vector<std::array<std::int32_t, 3>> surface_triangles(const PointCloud& cloud, const SurfaceSettings& settings) {
    const auto flat = flattened(cloud);
    const Delaunay delaunay(flat.begin(), flat.end());
    std::vector<Triangle> all;
    std::vector<double> sides;
    for (auto face = delaunay.finite_faces_begin(); face != delaunay.finite_faces_end(); ++face) {
        all.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
        sides.push_back(longest_side_mm(cloud, all.back()));
    }
    if (all.empty()) return all;
    const double most = std::min(settings.max_edge_medians * median(sides), settings.max_edge_mm);
    std::vector<Triangle> kept;
    kept.reserve(all.size());
    for (std::size_t i = 0; i < all.size(); ++i)
        if (sides[i] <= most) kept.push_back(all[i]);
    // The projector's picture has y down: the triangles all turn the same way, but not always outwards.
    if (has_normals(cloud) && agreement(cloud, kept) < 0)
        for (Triangle& t : kept) std::swap(t[1], t[2]);
    return kept;
}

}  // namespace planlight
