#include "tests/registration/matching/ray_grid.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace planlight::test {

using Eigen::Vector3d;

std::vector<std::size_t> RayGrid::those_that_met() const {
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < met.size(); ++i)
        if (met[i]) which.push_back(i);
    return which;
}

Vector3d RayGrid::normal_at(std::size_t ray) const {
    constexpr int kReach = 3;
    const double farthest_mm = 2.5 * kReach * spacing_mm + 1;
    const int row = static_cast<int>(ray) / columns, column = static_cast<int>(ray) % columns;
    Vector3d sum = Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    int count = 0;
    for (int j = std::max(0, row - kReach); j <= std::min(rows - 1, row + kReach); ++j)
        for (int i = std::max(0, column - kReach); i <= std::min(columns - 1, column + kReach); ++i) {
            const auto k = static_cast<std::size_t>(j * columns + i);
            if (!met[k]) continue;
            const Vector3d d = p[k] - p[ray];
            if (d.norm() > farthest_mm) continue;
            sum += d;
            squares += d * d.transpose();
            ++count;
        }
    if (count < 6) return -direction[ray];
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(squares / count - sum * sum.transpose() / (count * count));
    const Vector3d n = solver.eigenvectors().col(0);
    return n.dot(direction[ray]) > 0 ? Vector3d(-n) : n;
}

DepthSpoiler::Spoilt DepthSpoiler::next() {
    const double off = noise_mm_ * normal_(random_), stray = unit_(random_), way = unit_(random_), far = unit_(random_);
    const bool is_stray = stray < stray_share_;
    return {off + (is_stray ? (way < 0.5 ? -1 : 1) * (15 + 85 * far) : 0), is_stray};
}

std::vector<Vector3d> targets_round(const Vector3d& deep) {
    std::vector<Vector3d> targets{deep};
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-40., 40.}) targets.emplace_back(deep + side * Vector3d::Unit(axis));
    return targets;
}

}  // namespace planlight::test
