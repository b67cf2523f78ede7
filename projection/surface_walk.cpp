#include "projection/surface_walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace planlight {
namespace {

using Eigen::Vector3d;

std::uint64_t edge_key(std::int32_t a, std::int32_t b) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) | static_cast<std::uint32_t>(b);
}

}  // namespace

SurfaceWalk::SurfaceWalk(const TriangleMesh& mesh) : mesh_(mesh) {
    std::unordered_map<std::uint64_t, std::int32_t> triangle_of_edge;
    triangle_of_edge.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& v = mesh.triangles[t];
        const int i = static_cast<int>(t);
        face_normals_.push_back((corner(i, 1) - corner(i, 0)).cross(corner(i, 2) - corner(i, 0)).normalized());
        for (std::size_t e = 0; e < 3; ++e)
            triangle_of_edge.emplace(edge_key(v[e], v[(e + 1) % 3]), static_cast<std::int32_t>(t));
    }
    neighbours_.assign(mesh.triangles.size(), {-1, -1, -1});
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t e = 0; e < 3; ++e) {
            const auto& v = mesh.triangles[t];
            const auto other = triangle_of_edge.find(edge_key(v[(e + 1) % 3], v[e]));
            if (other != triangle_of_edge.end()) neighbours_[t][e] = other->second;
        }
}

Vector3d SurfaceWalk::corner(int triangle, int which) const {
    const auto& v = mesh_.triangles[static_cast<std::size_t>(triangle)];
    return mesh_.vertices_in_ct[static_cast<std::size_t>(v[static_cast<std::size_t>(which % 3)])];
}

Vector3d SurfaceWalk::outward(int triangle, int edge) const {
    return (corner(triangle, edge + 1) - corner(triangle, edge)).cross(face_normal(triangle)).normalized();
}

SurfaceWalk::Exit SurfaceWalk::find_exit(const Place& place) const {
    Exit exit;
    for (int e = 0; e < 3; ++e) {
        const Vector3d out = outward(place.triangle, e);
        const double speed = place.direction_in_ct.dot(out);
        if (!(speed > 1e-12)) continue;
        const double distance = std::max(0.0, (corner(place.triangle, e) - place.p_in_ct).dot(out) / speed);
        if (exit.edge < 0 || distance < exit.distance_mm) exit = {e, distance};
    }
    return exit;
}

bool SurfaceWalk::cross(Place& place, int edge) const {
    const int next = neighbours_[static_cast<std::size_t>(place.triangle)][static_cast<std::size_t>(edge)];
    if (next < 0) return false;
    const auto& back = neighbours_[static_cast<std::size_t>(next)];
    const auto entry = std::find(back.begin(), back.end(), place.triangle) - back.begin();
    if (entry == 3) return false;  // three triangles at one edge: not a surface here
    const Vector3d along = (corner(place.triangle, edge + 1) - corner(place.triangle, edge)).normalized();
    const double forward = place.direction_in_ct.dot(outward(place.triangle, edge));
    place.direction_in_ct =
        (place.direction_in_ct.dot(along) * along - forward * outward(next, static_cast<int>(entry))).normalized();
    place.triangle = next;
    return true;
}

std::optional<SurfaceWalk::Place> SurfaceWalk::go(Place place, double length_mm, const std::vector<double>& stops_mm,
                                                  const std::function<void(const Place&)>& visit) const {
    double way_mm = 0;
    std::size_t stop = 0;
    for (int crossed = 0; crossed < 200000; ++crossed) {
        const Exit exit = find_exit(place);
        if (exit.edge < 0) return std::nullopt;
        const double until_mm = std::min(way_mm + exit.distance_mm, length_mm);
        const bool arrived = way_mm + exit.distance_mm >= length_mm;
        for (; stop < stops_mm.size() && (stops_mm[stop] <= until_mm || arrived); ++stop) {
            Place here = place;
            here.p_in_ct += (std::min(stops_mm[stop], until_mm) - way_mm) * place.direction_in_ct;
            visit(here);
        }
        place.p_in_ct += (until_mm - way_mm) * place.direction_in_ct;
        way_mm = until_mm;
        if (arrived) return place;
        if (!cross(place, exit.edge)) return std::nullopt;
    }
    return std::nullopt;
}

std::vector<Vector3d> vertex_normals(const TriangleMesh& mesh) {
    std::vector<Vector3d> normals(mesh.vertices_in_ct.size(), Vector3d::Zero());
    for (const auto& v : mesh.triangles) {
        std::array<Vector3d, 3> p;
        for (std::size_t i = 0; i < 3; ++i) p[i] = mesh.vertices_in_ct[static_cast<std::size_t>(v[i])];
        const Vector3d n = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector3d a = p[(i + 1) % 3] - p[i], b = p[(i + 2) % 3] - p[i];
            normals[static_cast<std::size_t>(v[i])] += std::atan2(a.cross(b).norm(), a.dot(b)) * n;
        }
    }
    for (auto& n : normals) n.normalize();
    return normals;
}

}  // namespace planlight
