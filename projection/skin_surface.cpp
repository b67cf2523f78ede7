#include "projection/skin_surface.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "planning_io/types/error.h"
#include "projection/surface_walk.h"
#include "projection/triangle_tree.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using triangle_tree::Kernel, triangle_tree::Tree, triangle_tree::Triangles;
using triangle_tree::to_cgal, triangle_tree::to_eigen;

Kernel::Ray_3 to_cgal(const Ray& ray) {
    return {to_cgal(ray.origin), Kernel::Vector_3(ray.direction.x(), ray.direction.y(), ray.direction.z())};
}

void check(const TriangleMesh& mesh) {
    const char* remedy = "Make the skin surface again with `planlight prepare`.";
    if (mesh.triangles.empty()) throw InputError("", "the skin mesh has no triangles", remedy);
    for (std::size_t i = 0; i < mesh.vertices_in_ct.size(); ++i)
        if (!mesh.vertices_in_ct[i].allFinite())
            throw InputError("", fmt::format("vertex {} of the skin mesh is not finite", i), remedy);
    const auto count = static_cast<std::int64_t>(mesh.vertices_in_ct.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const auto v : mesh.triangles[t])
            if (v < 0 || v >= count)
                throw InputError("", fmt::format("triangle {} of the skin mesh names vertex {} of {}", t, v, count),
                                 remedy);
}

TriangleMesh checked(TriangleMesh mesh) {
    check(mesh);
    if (mesh.normals_in_ct.size() != mesh.vertices_in_ct.size()) mesh.normals_in_ct = vertex_normals(mesh);
    return mesh;
}

}  // namespace

struct SkinSurface::Parts {
    explicit Parts(TriangleMesh m) : mesh(checked(std::move(m))), walk(mesh) {
        triangles.reserve(mesh.triangles.size());
        for (const auto& v : mesh.triangles)
            triangles.emplace_back(to_cgal(vertex(v[0])), to_cgal(vertex(v[1])), to_cgal(vertex(v[2])));
        tree.rebuild(triangles.cbegin(), triangles.cend());
    }

    const Vector3d& vertex(std::int32_t i) const { return mesh.vertices_in_ct[static_cast<std::size_t>(i)]; }

    /// The shares of the triangle's second and third corner in a point of it.
    std::optional<Eigen::Vector2d> shares(int triangle, const Vector3d& p) const {
        const auto& v = mesh.triangles[static_cast<std::size_t>(triangle)];
        const Vector3d ab = vertex(v[1]) - vertex(v[0]), ac = vertex(v[2]) - vertex(v[0]), ap = p - vertex(v[0]);
        const Vector3d area = ab.cross(ac);
        const double whole = area.squaredNorm();
        if (!(whole > 0)) return std::nullopt;
        const double b = std::clamp(ap.cross(ac).dot(area) / whole, 0.0, 1.0);
        return Eigen::Vector2d(b, std::clamp(ab.cross(ap).dot(area) / whole, 0.0, 1.0 - b));
    }
    /// The smooth normal: the vertices' normals by barycentric coordinates.
    Vector3d normal_at(int triangle, const Vector3d& p) const {
        const auto& v = mesh.triangles[static_cast<std::size_t>(triangle)];
        const auto n = [&](std::size_t i) { return mesh.normals_in_ct[static_cast<std::size_t>(v[i])]; };
        const auto share = shares(triangle, p);
        if (!share) return n(0);
        return ((1 - share->sum()) * n(0) + share->x() * n(1) + share->y() * n(2)).normalized();
    }
    Point point(const Vector3d& p, int triangle) const { return {p, normal_at(triangle, p), triangle}; }
    int index(Triangles::const_iterator i) const { return static_cast<int>(i - triangles.cbegin()); }

    TriangleMesh mesh;
    SurfaceWalk walk;
    Triangles triangles;
    Tree tree;
};

SkinSurface::SkinSurface(TriangleMesh mesh) : parts_(std::make_unique<Parts>(std::move(mesh))) {}
SkinSurface::~SkinSurface() = default;
SkinSurface::SkinSurface(SkinSurface&&) noexcept = default;
SkinSurface& SkinSurface::operator=(SkinSurface&&) noexcept = default;

std::optional<SkinSurface::Point> SkinSurface::first_hit(const Ray& ray_in_ct) const {
    const auto hit = parts_->tree.first_intersection(to_cgal(ray_in_ct));
    if (!hit) return std::nullopt;
    const int triangle = parts_->index(hit->second);
    if (const auto* p = boost::get<Kernel::Point_3>(&hit->first)) return parts_->point(to_eigen(*p), triangle);
    const auto* segment = boost::get<Kernel::Segment_3>(&hit->first);  // the ray lies in the triangle's plane
    if (segment == nullptr) return std::nullopt;
    const Vector3d a = to_eigen(segment->source()), b = to_eigen(segment->target());
    const bool a_first = (a - ray_in_ct.origin).squaredNorm() < (b - ray_in_ct.origin).squaredNorm();
    return parts_->point(a_first ? a : b, triangle);
}

SkinSurface::Point SkinSurface::nearest(const Vector3d& p_in_ct) const {
    const auto found = parts_->tree.closest_point_and_primitive(to_cgal(p_in_ct));
    return parts_->point(to_eigen(found.first), parts_->index(found.second));
}

Vector3d SkinSurface::mean_normal(const Point& at, double radius_mm) const {
    constexpr double kFacing = 0.5;  // not the other side of an ear
    const TriangleMesh& mesh = parts_->mesh;
    Vector3d sum = Vector3d::Zero();
    for (const auto& t : mesh.triangles) {
        const Vector3d &a = parts_->vertex(t[0]), &b = parts_->vertex(t[1]), &c = parts_->vertex(t[2]);
        if (((a + b + c) / 3 - at.p_in_ct).squaredNorm() > radius_mm * radius_mm) continue;
        const Vector3d area = (b - a).cross(c - a);
        if (area.dot(at.normal_in_ct) > kFacing * area.norm()) sum += area;
    }
    return sum.norm() > 0 ? Vector3d(sum.normalized()) : at.normal_in_ct;
}

bool SkinSurface::inside(const Vector3d& p_in_ct) const {
    int votes = 0;  // three skew rays, so that one that grazes an edge is outvoted
    for (const Vector3d& direction :
         {Vector3d(0.832, 0.413, 0.371), Vector3d(-0.297, 0.871, 0.391), Vector3d(0.179, -0.354, 0.918)})
        votes += parts_->tree.number_of_intersected_primitives(to_cgal(Ray{p_in_ct, direction})) % 2 == 1;
    return votes >= 2;
}

std::optional<SkinSurface::Way> SkinSurface::walk_way(const Point& start, const Vector3d& tangent_in_ct,
                                                      double max_segment_mm) const {
    const double length_mm = tangent_in_ct.norm();
    if (start.triangle < 0 || !std::isfinite(length_mm)) return std::nullopt;
    if (!(length_mm > 1e-9)) return Way{{start}, start.normal_in_ct.unitOrthogonal()};
    const Vector3d tangent = tangent_in_ct - tangent_in_ct.dot(start.normal_in_ct) * start.normal_in_ct;
    if (!(tangent.norm() > 1e-6 * length_mm)) return std::nullopt;  // straight into the skin
    const Vector3d face = parts_->walk.face_normal(start.triangle);
    Vector3d direction = Eigen::Quaterniond::FromTwoVectors(start.normal_in_ct, face) * tangent;
    direction = (direction - direction.dot(face) * face).normalized();
    const auto segments = static_cast<std::size_t>(std::max(1.0, std::ceil(length_mm / max_segment_mm - 1e-9)));
    std::vector<double> stops_mm;
    for (std::size_t i = 1; i <= segments; ++i)
        stops_mm.push_back(length_mm * static_cast<double>(i) / static_cast<double>(segments));
    Way way{{start}, {}};
    way.points.reserve(segments + 1);
    const auto end =
        parts_->walk.go({start.triangle, start.p_in_ct, direction}, length_mm, stops_mm,
                        [&](const auto& place) { way.points.push_back(parts_->point(place.p_in_ct, place.triangle)); });
    if (!end) return std::nullopt;
    const Vector3d n = way.points.back().normal_in_ct;
    way.direction_at_end_in_ct =
        Eigen::Quaterniond::FromTwoVectors(parts_->walk.face_normal(end->triangle), n) * end->direction_in_ct;
    return way;
}

std::optional<SkinSurface::Point> SkinSurface::walk(const Point& start, const Vector3d& tangent_in_ct) const {
    auto way = walk_way(start, tangent_in_ct, std::max(1e-9, tangent_in_ct.norm()));
    if (!way) return std::nullopt;
    return way->points.back();
}

SkinSurface::Point SkinSurface::same_place(const SkinSurface& other, const Point& point) const {
    if (&other == this) return point;
    if (point.triangle < 0 || other.mesh().triangles.size() != mesh().triangles.size()) return nearest(point.p_in_ct);
    const auto& v = parts_->mesh.triangles[static_cast<std::size_t>(point.triangle)];
    const Eigen::Vector2d share = other.parts_->shares(point.triangle, point.p_in_ct).value_or(Eigen::Vector2d::Zero());
    const Vector3d p =
        (1 - share.sum()) * parts_->vertex(v[0]) + share.x() * parts_->vertex(v[1]) + share.y() * parts_->vertex(v[2]);
    return parts_->point(p, point.triangle);
}

bool SkinSurface::real_skin(const Point& point) const {
    const auto& flags = parts_->mesh.flags;
    if (flags.size() != parts_->mesh.vertices_in_ct.size() || point.triangle < 0) return true;
    const auto& v = parts_->mesh.triangles[static_cast<std::size_t>(point.triangle)];
    return std::all_of(v.begin(), v.end(), [&](std::int32_t i) { return flags[static_cast<std::size_t>(i)] == kSkin; });
}

const TriangleMesh& SkinSurface::mesh() const {
    return parts_->mesh;
}

}  // namespace planlight
