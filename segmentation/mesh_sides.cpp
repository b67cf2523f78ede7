#include "segmentation/mesh_sides.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

using Eigen::Vector3d;

std::size_t at(std::int32_t index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

MeshSides::MeshSides(const TriangleMesh& mesh)
    : mesh_(mesh), face_normals_(mesh.triangles.size()), corner_normals_(mesh.vertices_in_ct.size(), Vector3d::Zero()) {
    std::vector<Vector3d> angles(mesh.triangles.size());
    tbb::parallel_for(std::size_t{0}, angles.size(), [&](std::size_t t) {
        const auto corner = [&](std::size_t c) -> const Vector3d& {
            return mesh_.vertices_in_ct[at(mesh_.triangles[t][c % 3])];
        };
        face_normals_[t] = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
        for (std::size_t c = 0; c < 3; ++c) {
            const Vector3d u = (corner(c + 1) - corner(c)).normalized(), v = (corner(c + 2) - corner(c)).normalized();
            angles[t][static_cast<Eigen::Index>(c)] = std::acos(std::clamp(u.dot(v), -1.0, 1.0));
        }
    });
    for (std::size_t t = 0; t < angles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c)
            corner_normals_[at(mesh.triangles[t][c])] += angles[t][static_cast<Eigen::Index>(c)] * face_normals_[t];
    find_neighbours();
}

void MeshSides::find_neighbours() {
    neighbours_.resize(mesh_.triangles.size());
    for (std::size_t t = 0; t < neighbours_.size(); ++t) neighbours_[t].fill(static_cast<std::uint32_t>(t));
    struct EdgeUse {
        std::int32_t high;
        std::uint32_t triangle_and_corner;
    };
    const auto ends = [&](std::size_t t, std::size_t c) {
        return std::minmax(mesh_.triangles[t][(c + 1) % 3], mesh_.triangles[t][(c + 2) % 3]);
    };
    std::vector<std::uint32_t> begin(mesh_.vertices_in_ct.size() + 1, 0);  // of the edges whose lower end a vertex is
    for (std::size_t t = 0; t < neighbours_.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) ++begin[at(ends(t, c).first) + 1];
    for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
    std::vector<EdgeUse> edges(3 * neighbours_.size());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::size_t t = 0; t < neighbours_.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto [low, high] = ends(t, c);
            edges[next[at(low)]++] = {high, static_cast<std::uint32_t>(3 * t + c)};
        }
    for (std::size_t v = 0; v + 1 < begin.size(); ++v)
        for (std::uint32_t e = begin[v]; e < begin[v + 1]; ++e)
            for (std::uint32_t f = e + 1; f < begin[v + 1]; ++f) {
                if (edges[e].high != edges[f].high) continue;
                const std::uint32_t a = edges[e].triangle_and_corner, b = edges[f].triangle_and_corner;
                neighbours_[a / 3][a % 3] = b / 3;
                neighbours_[b / 3][b % 3] = a / 3;
            }
}

Vector3d MeshSides::normal_at(std::size_t triangle, const Vector3d& weights) const {
    for (int c = 0; c < 3; ++c)
        if (weights[c] >= 1) return corner_normals_[at(mesh_.triangles[triangle][at(c)])];
    for (int c = 0; c < 3; ++c)
        if (weights[c] <= 0) return face_normals_[triangle] + face_normals_[neighbours_[triangle][at(c)]];
    return face_normals_[triangle];
}

}  // namespace planlight
