#include "segmentation/signed_distance_grid.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "segmentation/closest_point_on_triangle.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

/// Pseudonormals: which side of the surface a point is on, whatever its nearest feature.
struct SidedTriangle {
    std::array<Vector3d, 3> corner;
    std::array<Vector3d, 3> corner_normal;
    std::array<Vector3d, 3> edge_normal;  ///< of the edge opposite to the corner
    Vector3d face_normal, centre;
    double radius;
};

struct EdgeUse {
    std::int32_t low, high;
    std::uint32_t triangle;
    std::uint8_t opposite;
    bool same_edge(const EdgeUse& other) const { return low == other.low && high == other.high; }
};

std::vector<EdgeUse> sorted_edges(const TriangleMesh& skin) {
    std::vector<EdgeUse> edges;
    edges.reserve(skin.triangles.size() * 3);
    for (std::size_t t = 0; t < skin.triangles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
            const auto a = skin.triangles[t][(c + 1) % 3], b = skin.triangles[t][(c + 2) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(t), static_cast<std::uint8_t>(c)});
        }
    std::sort(edges.begin(), edges.end(), [](const EdgeUse& a, const EdgeUse& b) {
        return a.low != b.low ? a.low < b.low : a.high < b.high;
    });
    return edges;
}

std::vector<SidedTriangle> sided_triangles(const TriangleMesh& skin) {
    std::vector<SidedTriangle> sided(skin.triangles.size());
    std::vector<Vector3d> corner_sum(skin.vertices_in_ct.size(), Vector3d::Zero());
    for (std::size_t t = 0; t < sided.size(); ++t) {
        SidedTriangle& s = sided[t];
        for (std::size_t c = 0; c < 3; ++c) s.corner[c] = skin.vertices_in_ct[at(skin.triangles[t][c])];
        s.face_normal = (s.corner[1] - s.corner[0]).cross(s.corner[2] - s.corner[0]).normalized();
        s.centre = (s.corner[0] + s.corner[1] + s.corner[2]) / 3;
        s.radius = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            s.radius = std::max(s.radius, (s.corner[c] - s.centre).norm());
            const Vector3d u = (s.corner[(c + 1) % 3] - s.corner[c]).normalized(), v = (s.corner[(c + 2) % 3] - s.corner[c]).normalized();
            corner_sum[at(skin.triangles[t][c])] += std::acos(std::clamp(u.dot(v), -1.0, 1.0)) * s.face_normal;
        }
        s.edge_normal.fill(s.face_normal);
    }
    const std::vector<EdgeUse> edges = sorted_edges(skin);
    for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
        if (!edges[e].same_edge(edges[e + 1])) continue;
        const Vector3d sum = sided[edges[e].triangle].face_normal + sided[edges[e + 1].triangle].face_normal;
        sided[edges[e].triangle].edge_normal[edges[e].opposite] = sum;
        sided[edges[e + 1].triangle].edge_normal[edges[e + 1].opposite] = sum;
    }
    for (std::size_t t = 0; t < sided.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) sided[t].corner_normal[c] = corner_sum[at(skin.triangles[t][c])];
    return sided;
}

/// The feature's pseudonormal for the weights of the closest point.
const Vector3d& normal_at(const SidedTriangle& s, const Vector3d& weights) {
    for (int c = 0; c < 3; ++c)
        if (weights[c] >= 1) return s.corner_normal[static_cast<std::size_t>(c)];
    for (int c = 0; c < 3; ++c)
        if (weights[c] <= 0) return s.edge_normal[static_cast<std::size_t>(c)];
    return s.face_normal;
}

class DistanceGrid {
public:
    explicit DistanceGrid(SkinLut& lut) : lut_(lut) {
        lut_.distance_mm.assign(at(lut.distance_size[0]) * at(lut.distance_size[1]) * at(lut.distance_size[2]), kFar);
    }

    void put_band(const std::vector<SidedTriangle>& triangles) {
        // Each task owns some layers of the grid, so no two write the same value.
        constexpr int kLayers = 6;
        const int blocks = (lut_.distance_size[2] + kLayers - 1) / kLayers;
        std::vector<std::vector<std::uint32_t>> bins(at(blocks));
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            const auto [low, high] = range(triangles[t]);
            for (int b = std::max(low.z(), 0) / kLayers; b <= std::min(high.z() / kLayers, blocks - 1); ++b)
                bins[at(b)].push_back(static_cast<std::uint32_t>(t));
        }
        tbb::parallel_for(0, blocks, [&](int b) {
            for (const auto t : bins[at(b)]) put(triangles[t], b * kLayers, std::min((b + 1) * kLayers, lut_.distance_size[2]));
        });
    }

    /// Beyond the band: the pointer's distance, with the sign of the band last crossed on the way from the table's side.
    void put_far() {
        tbb::parallel_for(0, lut_.distance_size[2], [&](int k) {
            for (int j = 0; j < lut_.distance_size[1]; ++j) {
                float* row = lut_.distance_mm.data() + index(0, j, k);
                bool inside = false;
                for (int i = 0; i < lut_.distance_size[0]; ++i) {
                    if (row[i] != kFar) {
                        inside = row[i] < 0;
                        continue;
                    }
                    const Vector3d p = position(i, j, k);
                    const auto mm = static_cast<float>((nearest_inside_table(p).position_in_ct.cast<double>() - p).norm());
                    row[i] = inside ? -mm : mm;
                }
            }
        });
    }

private:
    static constexpr float kFar = std::numeric_limits<float>::max();

    std::size_t index(int i, int j, int k) const {
        return (at(k) * at(lut_.distance_size[1]) + at(j)) * at(lut_.distance_size[0]) + at(i);
    }
    Vector3d position(int i, int j, int k) const { return lut_.origin_in_ct + lut_.distance_voxel_mm * Vector3d(i, j, k); }

    std::pair<Eigen::Vector3i, Eigen::Vector3i> range(const SidedTriangle& s) const {
        const Vector3d low = s.corner[0].cwiseMin(s.corner[1]).cwiseMin(s.corner[2]) - Vector3d::Constant(kExactBand_mm);
        const Vector3d high = s.corner[0].cwiseMax(s.corner[1]).cwiseMax(s.corner[2]) + Vector3d::Constant(kExactBand_mm);
        return {((low - lut_.origin_in_ct) / lut_.distance_voxel_mm).array().ceil().cast<int>(),
                ((high - lut_.origin_in_ct) / lut_.distance_voxel_mm).array().floor().cast<int>()};
    }

    void put(const SidedTriangle& s, int from_k, int to_k) {
        const auto [low, high] = range(s);
        for (int k = std::max(low.z(), from_k); k <= std::min(high.z(), to_k - 1); ++k)
            for (int j = std::max(low.y(), 0); j <= std::min(high.y(), lut_.distance_size[1] - 1); ++j)
                for (int i = std::max(low.x(), 0); i <= std::min(high.x(), lut_.distance_size[0] - 1); ++i)
                    offer(s, position(i, j, k), lut_.distance_mm[index(i, j, k)]);
    }

    static void offer(const SidedTriangle& s, const Vector3d& p, float& mm) {
        const double best = std::min<double>(std::abs(mm), kExactBand_mm);
        const Vector3d from_centre = p - s.centre;
        if (std::abs(from_centre.dot(s.face_normal)) >= best) return;
        if (from_centre.squaredNorm() >= (best + s.radius) * (best + s.radius)) return;
        const Vector3d w = closest_weights(p, s.corner[0], s.corner[1], s.corner[2]);
        const Vector3d offset = p - (w.x() * s.corner[0] + w.y() * s.corner[1] + w.z() * s.corner[2]);
        const double far = offset.norm();
        if (far >= best) return;
        mm = static_cast<float>(offset.dot(normal_at(s, w)) < 0 ? -far : far);
    }

    const SkinPoint& nearest_inside_table(const Vector3d& p) const {
        const Vector3d v = ((p - lut_.origin_in_ct) / lut_.voxel_mm).array().round();
        std::size_t n = 0;
        for (int a = 2; a >= 0; --a)
            n = n * at(lut_.size[at(a)]) + at(static_cast<std::int32_t>(std::clamp(v[a], 0.0, lut_.size[at(a)] - 1.0)));
        return lut_.skin[lut_.nearest[n]];
    }

    SkinLut& lut_;
};

}  // namespace

void fill_signed_distance(const TriangleMesh& skin, SkinLut& lut) {
    DistanceGrid grid(lut);
    grid.put_band(sided_triangles(skin));
    grid.put_far();
}

}  // namespace planlight
