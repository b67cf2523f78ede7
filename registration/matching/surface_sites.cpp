#include "registration/matching/surface_sites.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <unordered_map>

#include "planning_io/types/statistics.h"
#include "planning_io/types/triangle_mesh.h"
#include "registration/matching/cell_density.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr float kCell_mm = 5;
constexpr float kReach_mm = 5000;  // from the origin of the cells; a coordinate fits 11 bits

struct Cell {
    Vector3f position_sum = Vector3f::Zero(), normal_sum = Vector3f::Zero();
    int count = 0;
    Vector3i at = Vector3i::Zero();
};

/// Points sorted into cells; the cells in the order in which they were first met.
class CellMap {
public:
    explicit CellMap(const Vector3f& middle) : middle_(middle) {}

    void add(const Vector3f& p, const Vector3f& normal) {
        const Vector3f q = p - middle_;
        if (!(q.cwiseAbs().maxCoeff() < kReach_mm)) return;
        const Vector3i at = (q / kCell_mm).array().floor().cast<int>();
        const auto [found, fresh] = index_.try_emplace(key(at), static_cast<int>(cells_.size()));
        if (fresh) cells_.emplace_back().at = at;
        Cell& cell = cells_[static_cast<std::size_t>(found->second)];
        cell.position_sum += q;
        cell.normal_sum += normal;
        ++cell.count;
    }

    const std::vector<Cell>& cells() const { return cells_; }
    Vector3f mean_position(const Cell& cell) const {
        return middle_ + cell.position_sum / static_cast<float>(cell.count);
    }

    /// The sums over the 27 cells round `cell`.
    Cell neighbourhood(const Cell& cell) const {
        Cell sum;
        for (int k = -1; k <= 1; ++k)
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i) {
                    const auto found = index_.find(key(cell.at + Vector3i(i, j, k)));
                    if (found == index_.end()) continue;
                    const Cell& other = cells_[static_cast<std::size_t>(found->second)];
                    sum.position_sum += other.position_sum;
                    sum.normal_sum += other.normal_sum;
                    sum.count += other.count;
                }
        return sum;
    }

private:
    static std::uint64_t key(const Vector3i& at) {
        const auto part = [](int v) { return static_cast<std::uint64_t>(v + 1024) & 0x7ff; };
        return part(at.x()) | part(at.y()) << 11 | part(at.z()) << 22;
    }
    Vector3f middle_;
    std::unordered_map<std::uint64_t, int> index_;
    std::vector<Cell> cells_;
};

SurfaceSite site_of(const CellMap& map, const Cell& cell, const Cell& around) {
    const float length = around.normal_sum.norm();
    SurfaceSite site{map.mean_position(cell), Vector3f::Zero(), length > 0.75f * static_cast<float>(around.count)};
    if (length > 0) site.normal = around.normal_sum / length;
    return site;
}

/// Whether a cell's points lie on the surface of the cells round it: strays near the skin do not.
bool on_surface(const Cell& cell, const Cell& around) {
    constexpr float kOff_mm = 3;
    const float length = around.normal_sum.norm();
    if (length == 0) return true;
    const Vector3f between =
        cell.position_sum / static_cast<float>(cell.count) - around.position_sum / static_cast<float>(around.count);
    return std::abs(between.dot(around.normal_sum)) < kOff_mm * length;
}

/// Coordinate-wise median: strays, however far, do not move it.
Vector3f median_position(const std::vector<Vector3d>& points) {
    Vector3f middle = Vector3f::Zero();
    std::vector<float> values;
    for (int axis = 0; axis < 3; ++axis) {
        values.clear();
        for (const Vector3d& p : points)
            if (p.allFinite()) values.push_back(static_cast<float>(p[axis]));
        if (values.empty()) return middle;
        middle[axis] = median(std::move(values));
    }
    return middle;
}

}  // namespace

std::vector<SurfaceSite> sites_of_cloud(const PointCloud& cloud) {
    std::vector<SurfaceSite> sites;
    if (cloud.normals_in_rig.size() != cloud.size() || cloud.empty()) return sites;
    CellMap map(median_position(cloud.points_in_rig));
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const Vector3d& p = cloud.points_in_rig[i];
        const Vector3d& n = cloud.normals_in_rig[i];
        if (p.allFinite() && n.allFinite()) map.add(p.cast<float>(), n.cast<float>());
    }
    std::vector<Cell> around;
    std::vector<int> counts;
    const int most = most_to_count(map.cells(), &Cell::count);
    for (const Cell& cell : map.cells()) {
        around.push_back(map.neighbourhood(cell));
        for (int i = 0; i < std::min(cell.count, most); ++i)
            counts.push_back(around.back().count);  // as the typical point sees it
    }
    if (counts.empty()) return sites;
    const auto middle = median(counts);
    for (std::size_t i = 0; i < around.size(); ++i)
        if (around[i].count >= 0.2 * middle && on_surface(map.cells()[i], around[i]))
            sites.push_back(site_of(map, map.cells()[i], around[i]));
    return sites;
}

std::vector<SurfaceSite> sites_of_skin(const SkinLut& lut, double spacing_mm, unsigned seed) {
    std::vector<SurfaceSite> all, chosen;
    if (lut.skin.empty()) return chosen;
    CellMap map(lut.skin.front().position_in_ct);
    for (const SkinPoint& s : lut.skin)
        if (s.flags == kSkin && s.position_in_ct.allFinite() && s.normal_in_ct.allFinite())
            map.add(s.position_in_ct, s.normal_in_ct);
    for (const Cell& cell : map.cells()) {
        const SurfaceSite site = site_of(map, cell, map.neighbourhood(cell));
        if (site.contact) all.push_back(site);
    }
    std::mt19937 random(seed);
    for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random() % i]);
    const float least = static_cast<float>(spacing_mm * spacing_mm);
    for (const SurfaceSite& site : all) {
        const bool free = std::none_of(chosen.begin(), chosen.end(), [&](const SurfaceSite& other) {
            return (other.position - site.position).squaredNorm() < least && other.normal.dot(site.normal) > 0;
        });
        if (free) chosen.push_back(site);
    }
    return chosen;
}

}  // namespace planlight
