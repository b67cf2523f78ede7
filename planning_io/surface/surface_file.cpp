#include "planning_io/surface/surface_file.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "planning_io/dicom/rt_struct.h"
#include "planning_io/files/check_exists.h"
#include "planning_io/surface/dicom_seg.h"
#include "planning_io/surface/roi_surface.h"
#include "planning_io/surface/shape_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr std::size_t kFewestTriangles = 100;
constexpr double kLeastAcross_mm = 50, kMostAcross_mm = 600;
constexpr double kMostOddEdges = 1e-3;

struct Edge {
    std::int32_t low, high;
    std::int32_t triangle;
    bool forward;  ///< from the low to the high vertex
    bool same(const Edge& other) const { return low == other.low && high == other.high; }
};

std::vector<Edge> sorted_edges(const TriangleMesh& mesh) {
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto a = mesh.triangles[t][c], b = mesh.triangles[t][(c + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), a < b});
        }
    std::sort(edges.begin(), edges.end(),
              [](const Edge& a, const Edge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
    return edges;
}

/// Turns all triangles of a piece alike, and the piece outwards. Counts edges and pieces on its way.
class Turner {
public:
    Turner(SurfaceFile& surface, const fs::path& file) : surface_(surface), mesh_(surface.mesh), file_(file) {
        join_neighbours();
    }

    void turn() {
        std::vector<std::int8_t> turned(mesh_.triangles.size(), -1);  // -1 not seen, 0 as it is, 1 to be turned
        surface_.pieces = 0;
        for (std::size_t first = 0; first < turned.size(); ++first) {
            if (turned[first] >= 0) continue;
            ++surface_.pieces;
            const auto piece = collect(first, turned);
            for (const auto t : piece)
                if (turned[t] == 1) std::swap(mesh_.triangles[t][1], mesh_.triangles[t][2]);
            face_outwards(piece);
        }
    }

private:
    struct Neighbour {
        std::int32_t triangle;
        bool same_way;  ///< both run the edge in one direction: one of them must be turned
    };

    void join_neighbours() {
        neighbours_.resize(mesh_.triangles.size());
        const auto edges = sorted_edges(mesh_);
        std::size_t count = 0;
        for (std::size_t i = 0; i < edges.size();) {
            std::size_t end = i + 1;
            while (end < edges.size() && edges[i].same(edges[end])) ++end;
            ++count;
            if (end - i == 1) ++surface_.border_edges;
            if (end - i > 2) ++surface_.odd_edges;
            if (end - i == 2) {
                const Edge &a = edges[i], &b = edges[i + 1];
                neighbours_[static_cast<std::size_t>(a.triangle)].push_back({b.triangle, a.forward == b.forward});
                neighbours_[static_cast<std::size_t>(b.triangle)].push_back({a.triangle, a.forward == b.forward});
            }
            i = end;
        }
        surface_.closed = surface_.border_edges == 0;
        if (static_cast<double>(surface_.odd_edges) > kMostOddEdges * static_cast<double>(count))
            throw InputError(file_,
                             fmt::format("has {} edges of {} where three triangles or more meet: it is no surface",
                                         surface_.odd_edges, count),
                             "Repair the mesh and export it again.");
    }

    std::vector<std::size_t> collect(std::size_t first, std::vector<std::int8_t>& turned) const {
        std::vector<std::size_t> piece{first};
        turned[first] = 0;
        for (std::size_t i = 0; i < piece.size(); ++i)
            for (const Neighbour& n : neighbours_[piece[i]]) {
                const auto t = static_cast<std::size_t>(n.triangle);
                const auto wanted = static_cast<std::int8_t>(turned[piece[i]] ^ (n.same_way ? 1 : 0));
                if (turned[t] < 0) {
                    turned[t] = wanted;
                    piece.push_back(t);
                } else if (turned[t] != wanted) {
                    throw InputError(file_, "has an inside that runs over into its outside",
                                     "Repair the mesh and export it again.");
                }
            }
        return piece;
    }

    /// By the sum of the volumes of the triangles over the piece's middle: positive when the piece encloses it, or
    /// bulges away.
    void face_outwards(const std::vector<std::size_t>& piece) {
        const auto p = [&](std::size_t t, std::size_t c) {
            return mesh_.vertices_in_ct[static_cast<std::size_t>(mesh_.triangles[t][c])];
        };
        Vector3d middle = Vector3d::Zero();
        for (const auto t : piece) middle += (p(t, 0) + p(t, 1) + p(t, 2)) / (3 * static_cast<double>(piece.size()));
        double six_volumes = 0;
        for (const auto t : piece) six_volumes += (p(t, 0) - middle).dot((p(t, 1) - middle).cross(p(t, 2) - middle));
        if (six_volumes >= 0) return;
        for (const auto t : piece) std::swap(mesh_.triangles[t][1], mesh_.triangles[t][2]);
    }

    SurfaceFile& surface_;
    TriangleMesh& mesh_;
    const fs::path& file_;
    std::vector<std::vector<Neighbour>> neighbours_;
};

void set_normals(TriangleMesh& mesh) {
    mesh.normals_in_ct.assign(mesh.vertices_in_ct.size(), Vector3d::Zero());
    for (const auto& t : mesh.triangles) {
        const Vector3d& a = mesh.vertices_in_ct[static_cast<std::size_t>(t[0])];
        const Vector3d n = (mesh.vertices_in_ct[static_cast<std::size_t>(t[1])] - a)
                               .cross(mesh.vertices_in_ct[static_cast<std::size_t>(t[2])] - a);
        for (const auto corner : t) mesh.normals_in_ct[static_cast<std::size_t>(corner)] += n;
    }
    for (auto& n : mesh.normals_in_ct) n = n.norm() > 0 ? n.normalized() : Vector3d::UnitZ();
}

/// Points that no triangle uses are left out; triangles of no area too.
TriangleMesh used_part(const Shape& shape, Space space, std::size_t& degenerate) {
    TriangleMesh mesh;
    std::vector<std::int32_t> now(shape.points.size(), -1);
    for (const auto& t : shape.triangles) {
        const auto p = [&](std::size_t c) { return shape.points[static_cast<std::size_t>(t[c])]; };
        if ((p(1) - p(0)).cross(p(2) - p(0)).norm() == 0) {
            ++degenerate;
            continue;
        }
        std::array<std::int32_t, 3> corners{};
        for (std::size_t c = 0; c < 3; ++c) {
            auto& at = now[static_cast<std::size_t>(t[c])];
            if (at < 0) {
                at = static_cast<std::int32_t>(mesh.vertices_in_ct.size());
                mesh.vertices_in_ct.push_back(to_ct(p(c), space));
                if (!shape.flags.empty()) mesh.flags.push_back(shape.flags[static_cast<std::size_t>(t[c])]);
            }
            corners[c] = at;
        }
        mesh.triangles.push_back(corners);
    }
    return mesh;
}

void check_size(const TriangleMesh& mesh, const fs::path& file) {
    if (mesh.triangles.size() < kFewestTriangles)
        throw InputError(
            file, fmt::format("holds {} triangles: too few to be a surface to project on", mesh.triangles.size()),
            "Export the whole surface as triangles.");
    Vector3d low = mesh.vertices_in_ct.front(), high = low;
    for (const auto& p : mesh.vertices_in_ct) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const double across = (high - low).maxCoeff();
    if (!(across >= kLeastAcross_mm) || across > kMostAcross_mm)
        throw InputError(file,
                         fmt::format("is {:.3g} mm across, not between {:.0f} and {:.0f} mm", across, kLeastAcross_mm,
                                     kMostAcross_mm),
                         across < 1 ? "Export it in mm (it seems to be in metres)." : "Export it in mm.");
}

void describe(SurfaceFile& surface, const fs::path& file) {
    const std::string name = file.filename().string();
    if (!surface.closed)
        surface.notes.push_back(fmt::format("{} is open: {} edges at its border", name, surface.border_edges));
    if (surface.odd_edges > 0)
        surface.notes.push_back(fmt::format("{}: at {} edges three triangles or more meet", name, surface.odd_edges));
    if (surface.degenerate > 0)
        surface.notes.push_back(fmt::format("{}: {} triangles without area are left out", name, surface.degenerate));
    if (surface.pieces > 1) surface.notes.push_back(fmt::format("{} consists of {} pieces", name, surface.pieces));
}

}  // namespace

SurfaceFile surface_of(const Shape& welded, Space space, std::size_t degenerate, const fs::path& file) {
    SurfaceFile surface;
    surface.degenerate = degenerate;
    surface.mesh = used_part(welded, space, surface.degenerate);
    judge_surface(surface, file);
    return surface;
}

void judge_surface(SurfaceFile& surface, const fs::path& file) {
    Turner(surface, file).turn();
    set_normals(surface.mesh);
}

SurfaceFile read_surface(const fs::path& file, const SurfaceSettings& settings) {
    SurfaceFile surface;
    check_exists(file);
    if (!fs::is_regular_file(file)) throw InputError(file, "is no file", "Name the surface's file itself.");
    if (is_dicom_file(file)) {
        if (settings.said.space == Space::ras)
            throw InputError(file, "is DICOM, which is always LPS; --surface-frame says RAS",
                             "Leave --surface-frame out.");
        surface.mesh = is_rt_struct(file) ? read_roi_surface(file, settings.segment, settings.said, surface.notes)
                                          : read_dicom_seg(file, settings.segment, settings.said, surface.notes);
    } else {
        if (!settings.segment.empty()) throw InputError(file, "holds no named segments", "Leave --segment out.");
        const WeldedShape read = welded(read_shape(file));
        const Space space =
            settled_space(read.shape.space, settings.said.space, file,
                          "Export the surface with its space (3D Slicer does: SPACE=LPS)", "--surface-frame");
        surface.degenerate = read.degenerate;
        surface.mesh = used_part(read.shape, space, surface.degenerate);
    }
    check_size(surface.mesh, file);
    judge_surface(surface, file);
    describe(surface, file);
    return surface;
}

}  // namespace planlight
