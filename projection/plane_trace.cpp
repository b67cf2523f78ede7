#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "projection/skin_paths.h"
#include "projection/skin_place.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// The cut of the mesh with a plane as points on edges, each joined to at most two others.
struct Cut {
    std::vector<Vector3d> points;
    std::vector<std::vector<std::size_t>> joined;
};

/// Of the triangles at the end of the volume, or of all the others.
Cut cut_mesh(const SkinSurface& skin, const CutPlane& plane, bool at_end) {
    const TriangleMesh& mesh = skin.mesh();
    Cut cut;
    std::unordered_map<std::uint64_t, std::size_t> point_of_edge;
    const auto height = [&](std::int32_t v) {
        return plane.normal_in_ct.dot(mesh.vertices_in_ct[static_cast<std::size_t>(v)] - plane.origin_in_ct);
    };
    const auto point_on = [&](std::int32_t a, std::int32_t b) {
        if (a > b) std::swap(a, b);
        const auto key = (static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint32_t>(b);
        const auto [entry, fresh] = point_of_edge.emplace(key, cut.points.size());
        if (fresh) {
            const Vector3d& pa = mesh.vertices_in_ct[static_cast<std::size_t>(a)];
            const Vector3d& pb = mesh.vertices_in_ct[static_cast<std::size_t>(b)];
            cut.points.push_back(pa + height(a) / (height(a) - height(b)) * (pb - pa));
            cut.joined.emplace_back();
        }
        return entry->second;
    };
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& v = mesh.triangles[t];
        if ((flag_at(skin, static_cast<int>(t)) == kCutPlane) != at_end) continue;
        std::vector<std::size_t> ends;
        for (std::size_t e = 0; e < 3; ++e)
            if ((height(v[e]) >= 0) != (height(v[(e + 1) % 3]) >= 0)) ends.push_back(point_on(v[e], v[(e + 1) % 3]));
        if (ends.size() != 2) continue;
        cut.joined[ends[0]].push_back(ends[1]);
        cut.joined[ends[1]].push_back(ends[0]);
    }
    return cut;
}

using Chain = std::vector<Vector3d>;  // closed when its first point is its last again

std::vector<Chain> chains(const Cut& cut) {
    std::vector<Chain> found;
    std::vector<bool> used(cut.points.size(), false);
    const auto follow = [&](std::size_t start) {
        Chain chain{cut.points[start]};
        used[start] = true;
        for (std::size_t at = start;;) {
            const auto next =
                std::find_if(cut.joined[at].begin(), cut.joined[at].end(), [&](auto i) { return !used[i]; });
            if (next == cut.joined[at].end()) {
                const auto& j = cut.joined[at];
                if (chain.size() > 2 && std::find(j.begin(), j.end(), start) != j.end())
                    chain.push_back(cut.points[start]);
                return chain;
            }
            at = *next;
            used[at] = true;
            chain.push_back(cut.points[at]);
        }
    };
    for (std::size_t i = 0; i < cut.points.size(); ++i)
        if (!used[i] && cut.joined[i].size() == 1) found.push_back(follow(i));
    for (std::size_t i = 0; i < cut.points.size(); ++i)
        if (!used[i]) found.push_back(follow(i));
    return found;
}

/// The share [from, to] of segment a-b within the plane's rectangle (Liang & Barsky 1984). Empty outside.
std::optional<std::array<double, 2>> clip(const CutPlane& plane, const Vector3d& a, const Vector3d& b) {
    const Vector3d axes[2] = {plane.first_axis_in_ct, plane.normal_in_ct.cross(plane.first_axis_in_ct)};
    const double half[2] = {plane.width_mm / 2, plane.height_mm / 2};
    double from = 0, to = 1;
    for (int k = 0; k < 2; ++k) {
        const double at_a = axes[k].dot(a - plane.origin_in_ct), run = axes[k].dot(b - a);
        for (const double side : {-1.0, 1.0}) {
            const double room = half[k] - side * at_a, towards = side * run;
            if (towards == 0) {
                if (room < 0) return std::nullopt;
            } else if (towards > 0) {
                to = std::min(to, room / towards);
            } else {
                from = std::max(from, room / towards);
            }
        }
    }
    if (from >= to) return std::nullopt;
    return std::array<double, 2>{from, to};
}

std::vector<Chain> clipped(const CutPlane& plane, const Chain& chain) {
    std::vector<Chain> pieces;
    bool open = false;
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        const auto share = clip(plane, chain[i], chain[i + 1]);
        if (!share) {
            open = false;
            continue;
        }
        const Vector3d run = chain[i + 1] - chain[i];
        if (!open || (*share)[0] > 0) pieces.push_back({chain[i] + (*share)[0] * run});
        pieces.back().push_back(chain[i] + (*share)[1] * run);
        open = (*share)[1] >= 1;
    }
    const bool round = chain.size() > 2 && chain.front() == chain.back();
    if (round && pieces.size() > 1 && pieces.front().front() == pieces.back().back()) {  // the seam of a closed chain
        pieces.back().insert(pieces.back().end(), pieces.front().begin() + 1, pieces.front().end());
        pieces.erase(pieces.begin());
    }
    return pieces;
}

/// The chain with points at even distances of at most `max_segment_mm`.
SkinLine resampled(const SkinSurface& skin, const Chain& chain, double max_segment_mm) {
    double whole_mm = 0;
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) whole_mm += (chain[i + 1] - chain[i]).norm();
    const int n = std::max(1, static_cast<int>(std::ceil(whole_mm / max_segment_mm)));
    SkinLine line{{}, chain.size() > 3 && chain.front() == chain.back()};
    std::size_t segment = 0;
    double passed_mm = 0;
    for (int k = 0; k <= n - (line.closed ? 1 : 0); ++k) {
        const double way_mm = whole_mm * k / n;
        while (segment + 2 < chain.size() && passed_mm + (chain[segment + 1] - chain[segment]).norm() < way_mm) {
            passed_mm += (chain[segment + 1] - chain[segment]).norm();
            ++segment;
        }
        const Vector3d run = chain[segment + 1] - chain[segment];
        const double share = run.norm() > 0 ? std::clamp((way_mm - passed_mm) / run.norm(), 0.0, 1.0) : 0;
        line.points.push_back(skin.nearest(chain[segment] + share * run));
    }
    return line;
}

}  // namespace

std::vector<SkinLine> trace(const SkinSurface& skin, const CutPlane& plane, double max_segment_mm) {
    std::vector<SkinLine> lines;
    for (const Chain& chain : chains(cut_mesh(skin, plane, false)))
        for (const Chain& piece : clipped(plane, chain)) {
            SkinLine line = resampled(skin, piece, max_segment_mm);
            if (length_mm(line) >= 1) lines.push_back(std::move(line));
        }
    std::sort(lines.begin(), lines.end(), [](const auto& a, const auto& b) { return length_mm(a) > length_mm(b); });
    return lines;
}

double trace_at_end_mm(const SkinSurface& skin, const CutPlane& plane) {
    double sum_mm = 0;
    for (const Chain& chain : chains(cut_mesh(skin, plane, true)))
        for (const Chain& piece : clipped(plane, chain))
            for (std::size_t i = 0; i + 1 < piece.size(); ++i) sum_mm += (piece[i + 1] - piece[i]).norm();
    return sum_mm;
}

}  // namespace planlight
