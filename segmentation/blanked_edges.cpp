#include "segmentation/blanked_edges.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kSampleEvery = 7;
constexpr double kLeastShare = 0.01;  // of the volume that shows the one value
constexpr double kFull = 0.8;         // of what lies deeper: no blur has taken from it
constexpr double kCell_mm = 4;
constexpr int kReach = 2;  // cells to every side: a patch of 20 mm
constexpr double kPatch = 0.8, kUsual = 0.2, kLeastAway = 0.05;

/// The value that voxels below the threshold show most often; empty when they hardly repeat one.
std::optional<float> commonest_value(const Volume& volume, double threshold) {
    std::vector<float> sample;
    for (std::size_t v = 0; v < volume.values.size(); v += kSampleEvery)
        if (static_cast<double>(volume.values[v]) < threshold) sample.push_back(volume.values[v]);
    std::sort(sample.begin(), sample.end());
    std::size_t most = 0;
    float value = 0;
    for (std::size_t from = 0; from < sample.size();) {
        const auto to = static_cast<std::size_t>(
            std::upper_bound(sample.begin() + static_cast<std::ptrdiff_t>(from), sample.end(), sample[from]) -
            sample.begin());
        if (to - from > most) most = to - from, value = sample[from];
        from = to;
    }
    const double all = static_cast<double>(volume.values.size()) / static_cast<double>(kSampleEvery);
    return static_cast<double>(most) < kLeastShare * all ? std::nullopt : std::optional(value);
}

enum Edge : std::uint8_t { kSoft = 0, kBlank = 1, kHard = 2 };

/// What the volume shows across the skin at a vertex, along the array axis nearest to its normal.
Edge edge_at(const Volume& volume, const Eigen::Affine3d& voxel_from_ct, const Vector3d& p_in_ct,
             const Vector3d& normal_in_ct, float blank) {
    const Vector3d outwards = volume.ct_from_voxel.linear().transpose() * normal_in_ct;
    int axis = 0;
    outwards.cwiseAbs().maxCoeff(&axis);
    const Eigen::Vector3i at = (voxel_from_ct * p_in_ct).array().round().cast<int>();
    const auto value = [&](int out) {
        Eigen::Vector3i v = at;
        v[axis] += outwards[axis] > 0 ? out : -out;
        for (int a = 0; a < 3; ++a)
            if (v[a] < 0 || v[a] >= volume.size[static_cast<std::size_t>(a)]) return NAN;
        return volume.at(v.x(), v.y(), v.z());
    };
    int first = -2;
    while (first < 3 && value(first) != blank) ++first;
    if (first == 3 || value(first + 1) != blank) return kSoft;
    const float last = value(first - 1) - blank, deeper = (value(first - 2) + value(first - 3)) / 2 - blank;
    return last > static_cast<float>(kFull) * deeper ? kHard : kBlank;
}

/// How many vertices lie in the cells round a place, and how many of them have a hard edge.
class Patches {
public:
    Patches(const TriangleMesh& mesh, const std::vector<Edge>& edges) {
        low_ = mesh.vertices_in_ct.front();
        Vector3d high = low_;
        for (const Vector3d& p : mesh.vertices_in_ct) low_ = low_.cwiseMin(p), high = high.cwiseMax(p);
        size_ = ((high - low_) / kCell_mm).array().floor().cast<int>() + 1;
        counts_.assign(static_cast<std::size_t>(size_.prod()), {0, 0});
        for (std::size_t v = 0; v < edges.size(); ++v) {
            if (mesh.flags[v] != kSkin) continue;
            auto& [all, hard] = counts_[index_of(cell_of(mesh.vertices_in_ct[v]))];
            all += 1;
            hard += edges[v] == kHard;
        }
        shares_.assign(counts_.size(), 0);
        tbb::parallel_for(0, size_.z(), [&](int k) {
            for (int j = 0; j < size_.y(); ++j)
                for (int i = 0; i < size_.x(); ++i)
                    if (counts_[index_of({i, j, k})].first > 0) shares_[index_of({i, j, k})] = share_round({i, j, k});
        });
    }
    double share_at(const Vector3d& p_in_ct) const { return shares_[index_of(cell_of(p_in_ct))]; }
    /// Whether a cell near by, or its own, is of a patch.
    bool is_by_patch(const Vector3d& p_in_ct) const {
        bool found = false;
        for_cells_round(cell_of(p_in_ct), [&](std::size_t cell) { found = found || shares_[cell] > kPatch; });
        return found;
    }

private:
    Eigen::Vector3i cell_of(const Vector3d& p) const { return ((p - low_) / kCell_mm).array().floor().cast<int>(); }
    std::size_t index_of(const Eigen::Vector3i& c) const {
        return static_cast<std::size_t>((c.z() * size_.y() + c.y()) * size_.x() + c.x());
    }
    template <typename Visit>
    void for_cells_round(const Eigen::Vector3i& cell, Visit&& visit) const {
        const Eigen::Vector3i from = (cell.array() - kReach).max(0),
                              to = (cell.array() + kReach).min(size_.array() - 1);
        for (int k = from.z(); k <= to.z(); ++k)
            for (int j = from.y(); j <= to.y(); ++j)
                for (int i = from.x(); i <= to.x(); ++i) visit(index_of({i, j, k}));
    }
    double share_round(const Eigen::Vector3i& cell) const {
        double all = 0, hard = 0;
        for_cells_round(cell, [&](std::size_t c) { all += counts_[c].first, hard += counts_[c].second; });
        return all > 0 ? hard / all : 0;
    }
    Vector3d low_;
    Eigen::Vector3i size_;
    std::vector<std::pair<int, int>> counts_;
    std::vector<double> shares_;
};

}  // namespace

void flag_blanked_edges(TriangleMesh& mesh, const Volume& volume, double threshold) {
    if (mesh.vertices_in_ct.empty()) return;
    const auto blank = commonest_value(volume, threshold);
    if (!blank) return;
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    std::vector<Edge> edges(mesh.vertices_in_ct.size(), kSoft);
    tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t v) {
        if (mesh.flags[v] == kSkin)
            edges[v] = edge_at(volume, voxel_from_ct, mesh.vertices_in_ct[v], mesh.normals_in_ct[v], *blank);
    });
    if (std::find(edges.begin(), edges.end(), kHard) == edges.end()) return;
    const Patches patches(mesh, edges);
    std::size_t skin = 0, away = 0, usual = 0;  // away: from any such patch, where the skin's own edge shows
    for (std::size_t v = 0; v < edges.size(); ++v) {
        if (mesh.flags[v] != kSkin) continue;
        ++skin;
        if (patches.is_by_patch(mesh.vertices_in_ct[v])) continue;
        ++away;
        usual += patches.share_at(mesh.vertices_in_ct[v]) > kUsual;
    }
    if (2 * usual > away || static_cast<double>(away) < kLeastAway * static_cast<double>(skin)) return;
    for (std::size_t v = 0; v < edges.size(); ++v)
        if (edges[v] == kHard ? patches.is_by_patch(mesh.vertices_in_ct[v])
                              : edges[v] == kBlank && patches.share_at(mesh.vertices_in_ct[v]) > kPatch)
            mesh.flags[v] = kCutPlane;
}

}  // namespace planlight
