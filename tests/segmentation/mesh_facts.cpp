#include "tests/segmentation/mesh_facts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>

namespace planlight::test {
namespace {

std::size_t at(std::int32_t i) {
    return static_cast<std::size_t>(i);
}

std::size_t pieces_of(const TriangleMesh& mesh) {
    std::vector<std::int32_t> parent(mesh.vertices_in_ct.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](std::int32_t v) {
        while (parent[at(v)] != v) v = parent[at(v)] = parent[at(parent[at(v)])];
        return v;
    };
    for (const auto& t : mesh.triangles)
        for (const auto c : t) parent[at(root(c))] = root(t[0]);
    std::size_t pieces = 0;
    for (std::size_t v = 0; v < parent.size(); ++v) pieces += at(parent[v]) == v;
    return pieces;
}

}  // namespace

MeshFacts facts_of(const TriangleMesh& mesh) {
    MeshFacts facts;
    std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
    for (const auto& t : mesh.triangles) {
        const auto &a = mesh.vertices_in_ct[at(t[0])], &b = mesh.vertices_in_ct[at(t[1])],
                   &c = mesh.vertices_in_ct[at(t[2])];
        facts.volume_ml += a.dot(b.cross(c)) / 6000;
        const Eigen::Vector3d n = (b - a).cross(c - a).normalized();
        for (std::size_t e = 0; e < 3; ++e) {
            ++uses[{t[e], t[(e + 1) % 3]}];
            facts.longest_edge_mm =
                std::max(facts.longest_edge_mm,
                         (mesh.vertices_in_ct[at(t[e])] - mesh.vertices_in_ct[at(t[(e + 1) % 3])]).norm());
            facts.least_normal_dot = std::min(facts.least_normal_dot, n.dot(mesh.normals_in_ct[at(t[e])]));
        }
    }
    for (const auto& [edge, count] : uses) facts.bad_edges += count != 1 || !uses.contains({edge.second, edge.first});
    facts.pieces = pieces_of(mesh);
    facts.euler = static_cast<long>(mesh.vertices_in_ct.size()) - static_cast<long>(uses.size() / 2) +
                  static_cast<long>(mesh.triangles.size());
    return facts;
}

}  // namespace planlight::test
