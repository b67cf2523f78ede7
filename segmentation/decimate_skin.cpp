#include "segmentation/decimate_skin.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "segmentation/closest_point_on_triangle.h"
#include "segmentation/collapse_bound.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

struct Traits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    VertexAttributes(OpenMesh::Attributes::Status);
    FaceAttributes(OpenMesh::Attributes::Status);
    EdgeAttributes(OpenMesh::Attributes::Status);
    HalfedgeAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::PrevHalfedge);
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using Vertex = HalfEdgeMesh::VertexHandle;
using HalfEdge = HalfEdgeMesh::HalfedgeHandle;

constexpr double kLeastTurn = 0.7;     // cosine between a triangle and what replaces it
constexpr double kLeastQuality = 0.3;  // of a new triangle: 1 for equal sides, 0 for none left

class Decimation {
public:
    Decimation(const TriangleMesh& mesh, double max_edge_mm, double max_error_mm)
        : given_(mesh), max_edge_mm_(max_edge_mm), error_mm_(mesh.vertices_in_ct.size(), 0.0) {
        for (const auto& p : mesh.vertices_in_ct) halves_.add_vertex({p.x(), p.y(), p.z()});
        for (const auto& t : mesh.triangles)
            if (!halves_.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2])).is_valid())
                throw std::runtime_error("the skin surface is not a manifold");
        for (const double share : {0.1, 0.25, 0.5, 0.75, 1.0})
            for (const Vertex v : halves_.vertices()) try_to_remove(v, share * max_error_mm);
    }

    double most_mm() const { return most_mm_; }

    TriangleMesh result() const {
        TriangleMesh mesh;
        std::vector<std::int32_t> new_index(given_.vertices_in_ct.size(), -1);
        for (const Vertex v : halves_.vertices()) {
            const auto old = static_cast<std::size_t>(v.idx());
            if (halves_.status(v).deleted() || halves_.is_isolated(v)) continue;
            new_index[old] = static_cast<std::int32_t>(mesh.vertices_in_ct.size());
            mesh.vertices_in_ct.push_back(given_.vertices_in_ct[old]);
            if (!given_.normals_in_ct.empty()) mesh.normals_in_ct.push_back(given_.normals_in_ct[old]);
            if (!given_.flags.empty()) mesh.flags.push_back(given_.flags[old]);
            if (!given_.thickness_mm.empty()) mesh.thickness_mm.push_back(given_.thickness_mm[old]);
        }
        for (const auto f : halves_.faces()) {
            if (halves_.status(f).deleted()) continue;
            std::array<std::int32_t, 3> t{};
            std::size_t corner = 0;
            for (const Vertex v : halves_.fv_range(f)) t[corner++] = new_index[static_cast<std::size_t>(v.idx())];
            mesh.triangles.push_back(t);
        }
        return mesh;
    }

private:
    struct Way {
        double least_mm;
        HalfEdge along;
    };

    const Vector3d& point(Vertex v) const { return given_.vertices_in_ct[static_cast<std::size_t>(v.idx())]; }
    std::uint8_t flag(Vertex v) const {
        return given_.flags.empty() ? std::uint8_t{0} : given_.flags[static_cast<std::size_t>(v.idx())];
    }
    double& error_mm(Vertex v) { return error_mm_[static_cast<std::size_t>(v.idx())]; }

    void try_to_remove(Vertex v, double limit_mm) {
        if (halves_.status(v).deleted() || halves_.is_isolated(v) || halves_.is_boundary(v) || error_mm(v) >= limit_mm)
            return;
        ways_.clear();
        for (const HalfEdge h : halves_.voh_range(v)) {
            if (flag(halves_.to_vertex_handle(h)) != flag(v)) continue;
            const double total = error_mm(v) + deviation_mm(h);  // at least; the proof is dearer
            if (total <= limit_mm && halves_.is_collapse_ok(h)) ways_.push_back({total, h});
        }
        std::sort(ways_.begin(), ways_.end(), [](const Way& a, const Way& b) { return a.least_mm < b.least_mm; });
        for (const Way& way : ways_) {
            const auto bound_mm = proven_bound(way.along);
            if (!bound_mm || error_mm(v) + *bound_mm > limit_mm) continue;
            const double total = error_mm(v) + *bound_mm;
            most_mm_ = std::max(most_mm_, total);
            for (const Vertex ring : halves_.vv_range(v)) error_mm(ring) = std::max(error_mm(ring), total);
            halves_.collapse(way.along);
            return;
        }
    }

    std::optional<double> proven_bound(HalfEdge h) {
        ring_.clear();
        std::size_t target = 0;
        for (const HalfEdge s : halves_.voh_ccw_range(halves_.from_vertex_handle(h))) {
            if (s == h) target = ring_.size();
            ring_.push_back(point(halves_.to_vertex_handle(s)));
        }
        return collapse_bound(point(halves_.from_vertex_handle(h)), ring_, target);
    }

    /// Distance of the vertex from the triangles left when it is pulled along `h`; huge when one of them would be bad.
    double deviation_mm(HalfEdge h) const {
        constexpr double kNever = std::numeric_limits<double>::max();
        const Vertex from = halves_.from_vertex_handle(h), to = halves_.to_vertex_handle(h);
        const Vector3d &p = point(from), &q = point(to);
        double least = kNever;
        for (const HalfEdge s : halves_.voh_range(from)) {
            const Vertex a = halves_.to_vertex_handle(s);
            const Vertex b = halves_.to_vertex_handle(halves_.next_halfedge_handle(s));
            if (a == to || b == to) continue;
            const Vector3d &pa = point(a), &pb = point(b);
            const double aq = (q - pa).squaredNorm(), bq = (q - pb).squaredNorm(), ab = (pb - pa).squaredNorm();
            if (std::max(aq, bq) > max_edge_mm_ * max_edge_mm_) return kNever;
            const Vector3d before = (pa - p).cross(pb - p), after = (pa - q).cross(pb - q);
            const double size = after.norm();
            if (2 * std::sqrt(3.0) * size < kLeastQuality * (aq + bq + ab)) return kNever;
            if (before.dot(after) < kLeastTurn * size * before.norm()) return kNever;
            const Vector3d w = closest_weights(p, q, pa, pb);
            least = std::min(least, (w.x() * q + w.y() * pa + w.z() * pb - p).squaredNorm());
        }
        return least == kNever ? kNever : std::sqrt(least);
    }

    const TriangleMesh& given_;
    double max_edge_mm_;
    HalfEdgeMesh halves_;
    std::vector<double> error_mm_;  // proven for the triangles round each vertex
    double most_mm_ = 0;
    std::vector<Way> ways_;
    std::vector<Vector3d> ring_;
};

}  // namespace

TriangleMesh decimate_skin(const TriangleMesh& mesh, double max_edge_mm, double max_error_mm) {
    const Decimation decimation(mesh, max_edge_mm, max_error_mm);
    if (decimation.most_mm() > max_error_mm) throw std::logic_error("the decimation left its bound");
    return decimation.result();
}

}  // namespace planlight
