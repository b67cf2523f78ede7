#include "registration/matching/cloud_pieces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include "registration/matching/cell_density.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr float kCell_mm = 5, kReach_mm = 5000;
constexpr float kStep_mm = 1.2F, kStepPerMm = 0.35F;  ///< off the neighbour's plane: more is a step in depth
constexpr float kHollowCosine = 0.93F;                ///< about 21 degrees from cell to cell: a crease

std::uint64_t key_of(const Vector3i& at) {
    const auto part = [](int v) { return static_cast<std::uint64_t>(v + 1024) & 0x7ff; };
    return part(at.x()) | part(at.y()) << 11 | part(at.z()) << 22;
}

Vector3f median_position(const std::vector<Vector3d>& points) {
    Vector3f median = Vector3f::Zero();
    std::vector<float> values;
    for (int axis = 0; axis < 3; ++axis) {
        values.clear();
        for (const Vector3d& p : points)
            if (p.allFinite()) values.push_back(static_cast<float>(p[axis]));
        if (values.empty()) return median;
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        median[axis] = *middle;
    }
    return median;
}

/// The cells with their sums, and how to find the cells round one.
struct Cells {
    std::vector<CloudCell> cells;
    std::vector<Vector3f> normal_sum;
    std::vector<Vector3i> at;
    std::unordered_map<std::uint64_t, int> index;

    template <class Use>
    void each_beside(std::size_t i, const Use& use) const {
        for (int k = -1; k <= 1; ++k)
            for (int j = -1; j <= 1; ++j)
                for (int l = -1; l <= 1; ++l) {
                    if (k == 0 && j == 0 && l == 0) continue;
                    const auto found = index.find(key_of(at[i] + Vector3i(l, j, k)));
                    if (found != index.end()) use(static_cast<std::size_t>(found->second));
                }
    }
};

Cells gather(const PointCloud& cloud, std::vector<int>& cell_of_point) {
    Cells all;
    const Vector3f middle = median_position(cloud.points_in_rig);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const Vector3d &p = cloud.points_in_rig[i], &n = cloud.normals_in_rig[i];
        if (!p.allFinite() || !n.allFinite()) continue;
        const Vector3f q = p.cast<float>() - middle;
        if (!(q.cwiseAbs().maxCoeff() < kReach_mm)) continue;
        const Vector3i at = (q / kCell_mm).array().floor().cast<int>();
        const auto [found, fresh] = all.index.try_emplace(key_of(at), static_cast<int>(all.cells.size()));
        if (fresh) {
            all.cells.push_back({Vector3f::Zero(), Vector3f::Zero(), 0, false, -1, {}});
            all.normal_sum.push_back(Vector3f::Zero());
            all.at.push_back(at);
        }
        const auto c = static_cast<std::size_t>(found->second);
        all.cells[c].position += q;
        all.normal_sum[c] += n.cast<float>();
        ++all.cells[c].points;
        cell_of_point[i] = found->second;
    }
    for (std::size_t c = 0; c < all.cells.size(); ++c) {
        CloudCell& cell = all.cells[c];
        cell.position = middle + cell.position / static_cast<float>(cell.points);
        const float length = all.normal_sum[c].norm();
        if (length > 0.5F * static_cast<float>(cell.points)) cell.normal = all.normal_sum[c] / length;
    }
    return all;
}

/// Few points round it, or more than 3 mm off the surface of the cells round it.
void mark_strays(Cells& all) {
    constexpr double kFew = 0.2;
    constexpr float kOff_mm = 3;
    std::vector<int> around(all.cells.size());
    std::vector<char> off(all.cells.size(), 0);
    std::vector<int> as_seen;
    const int most = most_to_count(all.cells, &CloudCell::points);
    for (std::size_t c = 0; c < all.cells.size(); ++c) {
        const CloudCell& cell = all.cells[c];
        Vector3f sum = cell.position * static_cast<float>(cell.points), normals = all.normal_sum[c];
        int count = cell.points;
        all.each_beside(c, [&](std::size_t other) {
            sum += all.cells[other].position * static_cast<float>(all.cells[other].points);
            normals += all.normal_sum[other];
            count += all.cells[other].points;
        });
        around[c] = count;
        const float length = normals.norm();
        off[c] =
            length > 0 && std::abs((cell.position - sum / static_cast<float>(count)).dot(normals)) >= kOff_mm * length;
        for (int i = 0; i < std::min(cell.points, most); ++i) as_seen.push_back(count);
    }
    if (as_seen.empty()) return;
    const auto middle = as_seen.begin() + static_cast<std::ptrdiff_t>(as_seen.size() / 2);
    std::nth_element(as_seen.begin(), middle, as_seen.end());
    for (std::size_t c = 0; c < all.cells.size(); ++c)
        all.cells[c].stray = off[c] || around[c] < kFew * *middle || all.cells[c].normal.isZero();
}

/// Whether each of two cells lies in the plane of the other.
bool same_surface(const CloudCell& a, const CloudCell& b) {
    const Vector3f way = b.position - a.position;
    const float most_mm = kStep_mm + kStepPerMm * way.norm();
    return std::abs(way.dot(a.normal)) < most_mm && std::abs(way.dot(b.normal)) < most_mm &&
           a.normal.dot(b.normal) > 0.3F;
}

bool hollow_crease(const CloudCell& a, const CloudCell& b) {
    return a.normal.dot(b.normal) < kHollowCosine && (b.position - a.position).dot(b.normal - a.normal) < 0;
}

class Groups {
public:
    explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
    int root(int i) {
        while (parent_[at(i)] != i) i = parent_[at(i)] = parent_[at(parent_[at(i)])];
        return i;
    }
    void join(int a, int b) { parent_[at(root(a))] = root(b); }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    std::vector<int> parent_;
};

void number_pieces(Groups& groups, CloudPieces& result) {
    std::unordered_map<int, int> sizes;
    for (std::size_t c = 0; c < result.cells.size(); ++c)
        if (!result.cells[c].stray) ++sizes[groups.root(static_cast<int>(c))];
    std::vector<std::pair<int, int>> order;  // (-size, root): the largest first
    for (const auto& [root, size] : sizes) order.emplace_back(-size, root);
    std::sort(order.begin(), order.end());
    std::unordered_map<int, int> number;
    for (const auto& [size, root] : order) {
        number[root] = static_cast<int>(result.piece_cells.size());
        result.piece_cells.push_back(-size);
    }
    for (std::size_t c = 0; c < result.cells.size(); ++c)
        if (!result.cells[c].stray) result.cells[c].piece = number[groups.root(static_cast<int>(c))];
}

}  // namespace

CloudPieces cloud_pieces(const PointCloud& cloud) {
    CloudPieces result;
    result.cell_of_point.assign(cloud.size(), -1);
    if (cloud.normals_in_rig.size() != cloud.size()) return result;
    Cells all = gather(cloud, result.cell_of_point);
    mark_strays(all);
    Groups groups(all.cells.size());
    for (std::size_t a = 0; a < all.cells.size(); ++a) {
        if (all.cells[a].stray) continue;
        all.each_beside(a, [&](std::size_t b) {
            if (all.cells[b].stray || !same_surface(all.cells[a], all.cells[b])) return;
            all.cells[a].touching.push_back(static_cast<int>(b));
            if (!hollow_crease(all.cells[a], all.cells[b])) groups.join(static_cast<int>(a), static_cast<int>(b));
        });
    }
    result.cells = std::move(all.cells);
    number_pieces(groups, result);
    for (const int c : result.cell_of_point) {
        if (c < 0) continue;
        ++result.finite_points;
        result.stray_points += result.cells[static_cast<std::size_t>(c)].stray;
    }
    return result;
}

}  // namespace planlight
