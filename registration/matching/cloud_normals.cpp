#include "registration/matching/cloud_normals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kFew = 5, kEnough = 12;

/// Points by cubic cells as large as the radius: all neighbours of a point lie in 27 cells.
class CellGrid {
public:
    CellGrid(const std::vector<Vector3d>& points, double radius_mm) : points_(points), radius_mm_(radius_mm) {
        for (std::size_t i = 0; i < points.size(); ++i) cells_[key(cell_of(points[i]))].push_back(i);
    }
    template <class Use>
    void each_neighbour(const Vector3d& p, const Use& use) const {
        const auto c = cell_of(p);
        for (std::int64_t k = -1; k <= 1; ++k)
            for (std::int64_t j = -1; j <= 1; ++j)
                for (std::int64_t i = -1; i <= 1; ++i) {
                    const auto cell = cells_.find(key({c[0] + i, c[1] + j, c[2] + k}));
                    if (cell == cells_.end()) continue;
                    for (const std::size_t at : cell->second)
                        if ((points_[at] - p).squaredNorm() <= radius_mm_ * radius_mm_) use(points_[at]);
                }
    }

private:
    using Cell = std::array<std::int64_t, 3>;
    Cell cell_of(const Vector3d& p) const {
        return {static_cast<std::int64_t>(std::floor(p.x() / radius_mm_)),
                static_cast<std::int64_t>(std::floor(p.y() / radius_mm_)),
                static_cast<std::int64_t>(std::floor(p.z() / radius_mm_))};
    }
    static std::int64_t key(const Cell& c) { return (c[0] * 2097169 + c[1]) * 2097169 + c[2]; }

    const std::vector<Vector3d>& points_;
    double radius_mm_;
    std::unordered_map<std::int64_t, std::vector<std::size_t>> cells_;
};

/// The share of some of the points that have a dozen neighbours.
double share_with_enough(const std::vector<Vector3d>& points, const CellGrid& grid) {
    const std::size_t stride = std::max<std::size_t>(1, points.size() / 500);
    double enough = 0, all = 0;
    for (std::size_t i = 0; i < points.size(); i += stride, ++all) {
        std::size_t count = 0;
        grid.each_neighbour(points[i], [&](const Vector3d&) { ++count; });
        enough += count >= kEnough;
    }
    return enough / all;
}

}  // namespace

PointCloud with_normals(const PointCloud& cloud, const Vector3d& viewpoint_in_rig) {
    std::vector<Vector3d> points;
    for (const Vector3d& p : cloud.points_in_rig)
        if (p.allFinite()) points.push_back(p);
    PointCloud result;
    if (points.empty()) return result;
    double radius_mm = 2;
    while (radius_mm < 12 && share_with_enough(points, CellGrid(points, radius_mm)) < 0.8) radius_mm *= 1.4;
    const CellGrid grid(points, radius_mm);
    for (const Vector3d& p : points) {
        Vector3d sum = Vector3d::Zero();
        Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
        double count = 0;
        grid.each_neighbour(p, [&](const Vector3d& other) {
            const Vector3d r = other - p;
            sum += r;
            squares += r * r.transpose();
            ++count;
        });
        if (count < kFew) continue;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares / count -
                                                                    sum * sum.transpose() / (count * count));
        const Vector3d normal = solver.eigenvectors().col(0);
        result.points_in_rig.push_back(p);
        result.normals_in_rig.push_back(normal.dot(viewpoint_in_rig - p) < 0 ? Vector3d(-normal) : normal);
    }
    return result;
}

}  // namespace planlight
