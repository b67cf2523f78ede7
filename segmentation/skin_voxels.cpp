#include "segmentation/skin_voxels.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "segmentation/closest_point_on_triangle.h"
#include "segmentation/triangle_in_voxels.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using Corners = std::array<Vector3d, 3>;

constexpr int kLayers = 4;  // of the table that one task owns
constexpr std::uint32_t kNone = 0xFFFFFFFF;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

Corners corners_in_voxels(const TriangleMesh& skin, const SkinLut& lut, const std::array<std::int32_t, 3>& triangle) {
    Corners t;
    for (std::size_t c = 0; c < 3; ++c) t[c] = (skin.vertices_in_ct[at(triangle[c])] - lut.origin_in_ct) / lut.voxel_mm;
    return t;
}

/// The skin voxels of some layers of the table.
class Layers {
public:
    Layers(const TriangleMesh& skin, const SkinLut& lut, int first)
        : skin_(skin),
          lut_(lut),
          first_(first),
          end_(std::min(first + kLayers, lut.size[2])),
          number_(at(lut.size[0]) * at(lut.size[1]) * at(end_ - first), kNone) {}

    void mark(const std::array<std::int32_t, 3>& triangle) {
        const Corners t = corners_in_voxels(skin_, lut_, triangle);
        const TriangleInVoxels voxels(t);
        for (int k = std::max(voxels.low.z(), first_); k <= std::min(voxels.high.z(), end_ - 1); ++k)
            for (int j = voxels.low.y(); j <= voxels.high.y(); ++j)
                for (int i = voxels.low.x(); i <= voxels.high.x(); ++i)
                    if (voxels.passes({i, j, k})) offer(triangle, t, {i, j, k});
    }

    /// In the order of the table.
    std::vector<SkinPoint> sorted() const {
        std::vector<std::uint32_t> begin(at(lut_.size[1]) * at(end_ - first_) + 1, 0), order(points_.size());
        const auto row_of = [&](const SkinPoint& s) { return at(s.voxel[2] - first_) * at(lut_.size[1]) + s.voxel[1]; };
        for (const SkinPoint& s : points_) ++begin[row_of(s) + 1];
        for (std::size_t r = 1; r < begin.size(); ++r) begin[r] += begin[r - 1];
        std::vector<std::uint32_t> next = begin;
        for (std::size_t s = 0; s < points_.size(); ++s)
            order[next[row_of(points_[s])]++] = static_cast<std::uint32_t>(s);
        for (std::size_t r = 0; r + 1 < begin.size(); ++r)
            std::sort(order.begin() + begin[r], order.begin() + begin[r + 1],
                      [&](std::uint32_t a, std::uint32_t b) { return points_[a].voxel[0] < points_[b].voxel[0]; });
        std::vector<SkinPoint> result(points_.size());
        for (std::size_t s = 0; s < result.size(); ++s) result[s] = points_[order[s]];
        return result;
    }

private:
    void offer(const std::array<std::int32_t, 3>& triangle, const Corners& t, const Eigen::Vector3i& voxel) {
        const Vector3d weights = closest_weights(voxel.cast<double>(), t[0], t[1], t[2]);
        const Vector3d point = weights.x() * t[0] + weights.y() * t[1] + weights.z() * t[2];
        const double squared = (point - voxel.cast<double>()).squaredNorm();
        std::uint32_t& number =
            number_[(at(voxel.z() - first_) * at(lut_.size[1]) + at(voxel.y())) * at(lut_.size[0]) + at(voxel.x())];
        if (number == kNone) {
            number = static_cast<std::uint32_t>(points_.size());
            points_.emplace_back();
            squared_.push_back(squared);
        } else if (squared >= squared_[number]) {
            return;
        }
        squared_[number] = squared;
        SkinPoint& s = points_[number];
        s.position_in_ct = (lut_.origin_in_ct + lut_.voxel_mm * point).cast<float>();
        s.normal_in_ct = normal(triangle, t, weights).cast<float>();
        for (int a = 0; a < 3; ++a) s.voxel[at(a)] = static_cast<std::uint16_t>(voxel[a]);
        s.flags = 0;
        if (!skin_.flags.empty())
            for (const auto corner : triangle) s.flags |= skin_.flags[at(corner)];
        if (!skin_.thickness_mm.empty()) s.thickness_mm = thickness(triangle, weights);
    }

    Vector3d normal(const std::array<std::int32_t, 3>& triangle, const Corners& t, const Vector3d& weights) const {
        const Vector3d face = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
        if (skin_.normals_in_ct.empty()) return face;
        Vector3d sum = Vector3d::Zero();
        for (int c = 0; c < 3; ++c) sum += weights[c] * skin_.normals_in_ct[at(triangle[at(c)])];
        return sum.norm() > 1e-3 ? Vector3d(sum.normalized()) : face;
    }

    /// Not a number when it is not known at a corner that counts.
    float thickness(const std::array<std::int32_t, 3>& triangle, const Vector3d& weights) const {
        double sum = 0;
        for (int c = 0; c < 3; ++c)
            if (weights[c] > 0) sum += weights[c] * static_cast<double>(skin_.thickness_mm[at(triangle[at(c)])]);
        return static_cast<float>(sum);
    }

    const TriangleMesh& skin_;
    const SkinLut& lut_;
    int first_, end_;
    std::vector<std::uint32_t> number_;  // of each voxel in points_
    std::vector<SkinPoint> points_;
    std::vector<double> squared_;  // distance of each point from its voxel's centre, voxels
};

/// For each group of layers the triangles that may pass through it, in their order.
std::vector<std::vector<std::uint32_t>> triangles_of_layers(const TriangleMesh& skin, const SkinLut& lut) {
    std::vector<std::vector<std::uint32_t>> groups(at((lut.size[2] + kLayers - 1) / kLayers));
    for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
        double low = INFINITY, high = -INFINITY;
        for (const auto corner : skin.triangles[t]) {
            const double z = (skin.vertices_in_ct[at(corner)].z() - lut.origin_in_ct.z()) / lut.voxel_mm;
            low = std::min(low, z);
            high = std::max(high, z);
        }
        const auto first = static_cast<int>(std::floor(low + 0.5)) / kLayers,
                   last = static_cast<int>(std::floor(high + 0.5)) / kLayers;
        for (int g = first; g <= last; ++g) groups[at(g)].push_back(static_cast<std::uint32_t>(t));
    }
    return groups;
}

}  // namespace

void mark_skin_voxels(const TriangleMesh& skin, SkinLut& lut) {
    const auto groups = triangles_of_layers(skin, lut);
    std::vector<std::vector<SkinPoint>> found(groups.size());
    tbb::parallel_for(std::size_t{0}, groups.size(), [&](std::size_t g) {
        if (groups[g].empty()) return;
        Layers layers(skin, lut, static_cast<int>(g) * kLayers);
        for (const auto t : groups[g]) layers.mark(skin.triangles[t]);
        found[g] = layers.sorted();
    });
    lut.skin.clear();
    for (const auto& points : found) lut.skin.insert(lut.skin.end(), points.begin(), points.end());
}

}  // namespace planlight
