#include "segmentation/signed_distance_grid.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "segmentation/closest_point_on_triangle.h"
#include "segmentation/mesh_sides.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr float kUnknown = std::numeric_limits<float>::max();
constexpr int kRow = 8;             // nodes that are looked at together
constexpr int kLayers = 6;          // of the grid that one task owns
constexpr float kSlack_mm = 1e-3F;  // above the rounding of all that is kept as float

std::size_t at(std::int32_t index) {
    return static_cast<std::size_t>(index);
}

/// A triangle and a box of nodes, seen from the triangle's centre; mm.
struct Look {
    float x, y, z;  ///< the first node
    float step;
    float normal_x, normal_y, normal_z;
    float radius;  ///< of the triangle round its centre
    int count_x, count_y, count_z;
    std::size_t first, row, slab;  ///< node's index, and strides
};

/// The nodes that may lie nearer to the triangle than `bound_mm` says: their distance from its plane, and within the
/// plane from its circle, leaves that open. Appends their indices to `found`, returns how many.
__attribute__((target_clones("avx2", "default"))) std::size_t open_nodes(const Look& look, const float* bound_mm,
                                                                         std::uint32_t* found) {
    std::size_t count = 0;
    for (int k = 0; k < look.count_z; ++k)
        for (int j = 0; j < look.count_y; ++j) {
            const float y = look.y + static_cast<float>(j) * look.step, z = look.z + static_cast<float>(k) * look.step;
            const float across = y * y + z * z, plane_yz = y * look.normal_y + z * look.normal_z;
            const std::size_t row = look.first + at(k) * look.slab + at(j) * look.row;
            for (int i = 0; i < look.count_x; i += kRow) {
                const float* bound = bound_mm + row + i;
                std::int32_t open[kRow], any = 0;
                for (int l = 0; l < kRow; ++l) {
                    const float x = look.x + static_cast<float>(i + l) * look.step;
                    const float plane = x * look.normal_x + plane_yz, within = x * x + across - plane * plane;
                    const float room = bound[l] * bound[l] - plane * plane;  // squared distance left within the plane
                    const float over = within - look.radius * look.radius - room;
                    // within <= (radius + sqrt(room))^2, without the root
                    open[l] = (room > 0) & ((over <= 0) | (over * over <= 4 * look.radius * look.radius * room));
                    any |= open[l];
                }
                if (!any) continue;
                for (int l = 0; l < kRow && i + l < look.count_x; ++l)
                    if (open[l]) found[count++] = static_cast<std::uint32_t>(row + at(i + l));
            }
        }
    return count;
}

class DistanceGrid {
public:
    DistanceGrid(const TriangleMesh& skin, SkinLut& lut)
        : skin_(skin),
          lut_(lut),
          sides_(skin),
          row_(at(lut.distance_size[0])),
          slab_(row_ * at(lut.distance_size[1])),
          bound_mm_(slab_ * at(lut.distance_size[2])) {
        lut_.distance_mm = {};
        lut_.distance_mm.resize(slab_ * at(lut.distance_size[2]));
        put_bounds();
        put_band();
        put_signs();
    }

private:
    /// What one task owns while the band is put.
    struct Layers {
        int begin, end;
        std::size_t first_node;
        std::vector<float> bound_mm;  ///< of the layers' nodes, and a row more; falls to the distance
        std::vector<std::uint32_t> open;
    };

    /// No node is further from the skin than from the point behind its pointer.
    void put_bounds() {
        std::array<std::vector<std::size_t>, 3> voxel;  // of the table, for each node along each axis
        for (std::size_t a = 0; a < 3; ++a)
            for (int n = 0; n < lut_.distance_size[a]; ++n)
                voxel[a].push_back(static_cast<std::size_t>(
                    std::min(std::round(n * lut_.distance_voxel_mm / lut_.voxel_mm), lut_.size[a] - 1.0)));
        tbb::parallel_for(0, lut_.distance_size[2], [&](int k) {
            for (int j = 0; j < lut_.distance_size[1]; ++j) {
                const std::uint32_t* pointers =
                    lut_.nearest.data() + (voxel[2][at(k)] * at(lut_.size[1]) + voxel[1][at(j)]) * at(lut_.size[0]);
                const std::size_t row = at(k) * slab_ + at(j) * row_;
                for (int i = 0; i < lut_.distance_size[0]; ++i) {
                    const auto& skin = lut_.skin[pointers[voxel[0][at(i)]]].position_in_ct;
                    bound_mm_[row + at(i)] = (position(i, j, k).cast<float>() - skin).norm();
                    lut_.distance_mm[row + at(i)] = kUnknown;
                }
            }
        });
    }

    void put_band() {
        // Each task owns some layers of the grid, so no two write the same value.
        const int blocks = (lut_.distance_size[2] + kLayers - 1) / kLayers;
        std::vector<std::vector<std::uint32_t>> bins(at(blocks));
        for (std::size_t t = 0; t < skin_.triangles.size(); ++t) {
            const auto [low, high] = range(t);
            for (int b = low.z() / kLayers; b <= std::min(high.z() / kLayers, blocks - 1); ++b)
                bins[at(b)].push_back(static_cast<std::uint32_t>(t));
        }
        tbb::parallel_for(0, blocks, [&](int b) {
            Layers layers{
                b * kLayers, std::min((b + 1) * kLayers, lut_.distance_size[2]), at(b * kLayers) * slab_, {}, {}};
            const auto first = bound_mm_.begin() + static_cast<std::ptrdiff_t>(layers.first_node);
            layers.bound_mm.assign(first, first + static_cast<std::ptrdiff_t>(at(layers.end - layers.begin) * slab_));
            for (float& bound : layers.bound_mm) bound = std::min(bound + kSlack_mm, static_cast<float>(kExactBand_mm));
            layers.bound_mm.resize(layers.bound_mm.size() + kRow, 0.0F);
            for (const auto t : bins[at(b)]) put(t, layers);
        });
    }

    /// Beyond the band: the pointer's distance, with the sign of the band last crossed on the way from the table's
    /// side.
    void put_signs() {
        tbb::parallel_for(std::size_t{0}, lut_.distance_mm.size() / row_, [&](std::size_t line) {
            float* row = lut_.distance_mm.data() + line * row_;
            bool inside = false;
            for (std::size_t i = 0; i < row_; ++i) {
                const float mm = bound_mm_[line * row_ + i];
                if (row[i] != kUnknown)
                    inside = row[i] < 0;
                else
                    row[i] = inside ? -mm : mm;
            }
        });
    }

    Vector3d position(int i, int j, int k) const {
        return lut_.origin_in_ct + lut_.distance_voxel_mm * Vector3d(i, j, k);
    }
    const Vector3d& corner(std::size_t t, std::size_t c) const {
        return skin_.vertices_in_ct[at(skin_.triangles[t][c])];
    }

    /// First and last nodes within the band round a triangle.
    std::pair<Eigen::Vector3i, Eigen::Vector3i> range(std::size_t t) const {
        const Vector3d low =
            corner(t, 0).cwiseMin(corner(t, 1)).cwiseMin(corner(t, 2)) - Vector3d::Constant(kExactBand_mm);
        const Vector3d high =
            corner(t, 0).cwiseMax(corner(t, 1)).cwiseMax(corner(t, 2)) + Vector3d::Constant(kExactBand_mm);
        const Eigen::Vector3i last(lut_.distance_size[0] - 1, lut_.distance_size[1] - 1, lut_.distance_size[2] - 1);
        return {
            ((low - lut_.origin_in_ct) / lut_.distance_voxel_mm).array().ceil().cast<int>().cwiseMax(0),
            ((high - lut_.origin_in_ct) / lut_.distance_voxel_mm).array().floor().cast<int>().matrix().cwiseMin(last)};
    }

    void put(std::size_t t, Layers& layers) {
        auto [low, high] = range(t);
        low.z() = std::max(low.z(), layers.begin);
        high.z() = std::min(high.z(), layers.end - 1);
        const Eigen::Vector3i count = high - low + Eigen::Vector3i::Ones();
        if (count.minCoeff() <= 0) return;
        const Vector3d centre = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3;
        double radius = 0;
        for (std::size_t c = 0; c < 3; ++c) radius = std::max(radius, (corner(t, c) - centre).norm());
        const Eigen::Vector3f first = (position(low.x(), low.y(), low.z()) - centre).cast<float>(),
                              normal = sides_.face_normal(t).cast<float>();
        const std::size_t first_node = at(low.z() - layers.begin) * slab_ + at(low.y()) * row_ + at(low.x());
        const Look look{first.x(),  first.y(),  first.z(),  static_cast<float>(lut_.distance_voxel_mm),
                        normal.x(), normal.y(), normal.z(), static_cast<float>(radius) + kSlack_mm,
                        count.x(),  count.y(),  count.z(),  first_node,
                        row_,       slab_};
        layers.open.resize(static_cast<std::size_t>(count.prod()));
        const std::size_t found = open_nodes(look, layers.bound_mm.data(), layers.open.data());
        for (std::size_t n = 0; n < found; ++n)
            offer(t, layers.first_node + layers.open[n], layers.bound_mm[layers.open[n]]);
    }

    void offer(std::size_t t, std::size_t node, float& bound_mm) {
        const Vector3d p = position(static_cast<int>(node % row_), static_cast<int>(node % slab_ / row_),
                                    static_cast<int>(node / slab_));
        const Vector3d w = closest_weights(p, corner(t, 0), corner(t, 1), corner(t, 2));
        const Vector3d offset = p - (w.x() * corner(t, 0) + w.y() * corner(t, 1) + w.z() * corner(t, 2));
        const double far = offset.norm();
        if (far >= static_cast<double>(bound_mm)) return;
        bound_mm = static_cast<float>(far);
        lut_.distance_mm[node] = static_cast<float>(offset.dot(sides_.normal_at(t, w)) < 0 ? -far : far);
    }

    const TriangleMesh& skin_;
    SkinLut& lut_;
    MeshSides sides_;
    std::size_t row_, slab_;
    LargeArray<float> bound_mm_;
};

}  // namespace

void fill_signed_distance(const TriangleMesh& skin, SkinLut& lut) {
    DistanceGrid(skin, lut);
}

}  // namespace planlight
