#include "segmentation/skin_voxels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "segmentation/closest_point_on_triangle.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using Corners = std::array<Vector3d, 3>;

/// Separating axes of a triangle and the cube of half side 1/2 round the origin (Akenine-Moller 2001), without the box
/// axes: the caller walks only the boxes of the triangle's bounds.
bool overlaps_unit_cube(const Corners& t) {
    constexpr double kHalf = 0.5 + 1e-9;
    const std::array<Vector3d, 3> edges{t[1] - t[0], t[2] - t[1], t[0] - t[2]};
    const Vector3d normal = edges[0].cross(edges[1]);
    if (std::abs(normal.dot(t[0])) > kHalf * normal.cwiseAbs().sum()) return false;
    for (const Vector3d& e : edges)
        for (int axis = 0; axis < 3; ++axis) {
            const Vector3d n = e.cross(Vector3d::Unit(axis));
            const double a = n.dot(t[0]), b = n.dot(t[1]), c = n.dot(t[2]);
            const double reach = kHalf * n.cwiseAbs().sum();
            if (std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach) return false;
        }
    return true;
}

class Marker {
public:
    Marker(const TriangleMesh& skin, SkinLut& lut) : skin_(skin), lut_(lut) {
        for (const auto& triangle : skin.triangles) mark(triangle);
        sort();
    }

private:
    void mark(const std::array<std::int32_t, 3>& triangle) {
        Corners t;  // in voxels
        for (std::size_t c = 0; c < 3; ++c)
            t[c] = (skin_.vertices_in_ct[static_cast<std::size_t>(triangle[c])] - lut_.origin_in_ct) / lut_.voxel_mm;
        const Eigen::Vector3i low = (t[0].cwiseMin(t[1]).cwiseMin(t[2]).array() + 0.5).floor().cast<int>();
        const Eigen::Vector3i high = (t[0].cwiseMax(t[1]).cwiseMax(t[2]).array() + 0.5).floor().cast<int>();
        for (int k = low.z(); k <= high.z(); ++k)
            for (int j = low.y(); j <= high.y(); ++j)
                for (int i = low.x(); i <= high.x(); ++i) {
                    const Vector3d centre(i, j, k);
                    if (overlaps_unit_cube({t[0] - centre, t[1] - centre, t[2] - centre})) offer(triangle, t, {i, j, k});
                }
    }

    void offer(const std::array<std::int32_t, 3>& triangle, const Corners& t, const Eigen::Vector3i& voxel) {
        const Vector3d weights = closest_weights(voxel.cast<double>(), t[0], t[1], t[2]);
        const Vector3d point = weights.x() * t[0] + weights.y() * t[1] + weights.z() * t[2];
        const double squared = (point - voxel.cast<double>()).squaredNorm();
        std::uint32_t& at = lut_.nearest[index(voxel)];
        if (at == kNoSkin) {
            at = static_cast<std::uint32_t>(lut_.skin.size());
            lut_.skin.emplace_back();
            squared_.push_back(squared);
        } else if (squared >= squared_[at]) {
            return;
        }
        squared_[at] = squared;
        SkinPoint& s = lut_.skin[at];
        s.position_in_ct = (lut_.origin_in_ct + lut_.voxel_mm * point).cast<float>();
        s.normal_in_ct = normal(triangle, t, weights).cast<float>();
        for (int a = 0; a < 3; ++a) s.voxel[static_cast<std::size_t>(a)] = static_cast<std::uint16_t>(voxel[a]);
        s.flags = 0;
        if (!skin_.flags.empty())
            for (const auto corner : triangle) s.flags |= skin_.flags[static_cast<std::size_t>(corner)];
    }

    Vector3d normal(const std::array<std::int32_t, 3>& triangle, const Corners& t, const Vector3d& weights) const {
        const Vector3d face = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
        if (skin_.normals_in_ct.empty()) return face;
        Vector3d sum = Vector3d::Zero();
        for (int c = 0; c < 3; ++c)
            sum += weights[c] * skin_.normals_in_ct[static_cast<std::size_t>(triangle[static_cast<std::size_t>(c)])];
        return sum.norm() > 1e-3 ? Vector3d(sum.normalized()) : face;
    }

    std::size_t index(const Eigen::Vector3i& v) const {
        return (static_cast<std::size_t>(v.z()) * static_cast<std::size_t>(lut_.size[1]) + static_cast<std::size_t>(v.y())) *
                   static_cast<std::size_t>(lut_.size[0]) + static_cast<std::size_t>(v.x());
    }

    void sort() {
        std::vector<SkinPoint>& skin = lut_.skin;
        std::sort(skin.begin(), skin.end(), [](const SkinPoint& a, const SkinPoint& b) {
            return std::lexicographical_compare(a.voxel.rbegin(), a.voxel.rend(), b.voxel.rbegin(), b.voxel.rend());
        });
        for (std::size_t s = 0; s < skin.size(); ++s)
            lut_.nearest[index({skin[s].voxel[0], skin[s].voxel[1], skin[s].voxel[2]})] = static_cast<std::uint32_t>(s);
    }

    const TriangleMesh& skin_;
    SkinLut& lut_;
    std::vector<double> squared_;  // distance of each skin voxel's point from its centre, voxels
};

}  // namespace

void mark_skin_voxels(const TriangleMesh& skin, SkinLut& lut) {
    lut.skin.clear();
    lut.nearest.assign(static_cast<std::size_t>(lut.size[0]) * static_cast<std::size_t>(lut.size[1]) *
                           static_cast<std::size_t>(lut.size[2]), kNoSkin);
    Marker(skin, lut);
}

}  // namespace planlight
