#include "segmentation/collapse_bound.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double cross(const Vector2d& a, const Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// Along which the fans are seen: the sum of the old fan's area normals.
std::optional<Eigen::Matrix<double, 2, 3>> view_of(const Vector3d& v, std::span<const Vector3d> ring) {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 0; i < ring.size(); ++i) sum += (ring[i] - v).cross(ring[(i + 1) % ring.size()] - v);
    if (!(sum.norm() > 0)) return std::nullopt;
    const Vector3d normal = sum.normalized(), across = normal.unitOrthogonal();
    Eigen::Matrix<double, 2, 3> view;
    view << across.transpose(), normal.cross(across).transpose();
    return view;
}

/// Whether the fan from (0, 0) covers the polygon once: every triangle turns left, once round in all.
bool covers_once(std::span<const Vector2d> ring) {
    int rounds = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
        if (!(cross(a, b) > 0)) return false;
        rounds += a.y() < 0 && b.y() >= 0;
    }
    return rounds == 1;
}

}  // namespace

std::optional<double> collapse_bound(const Vector3d& v, std::span<const Vector3d> ring, std::size_t target) {
    const auto view = view_of(v, ring);
    if (!view) return std::nullopt;
    const std::size_t n = ring.size();
    thread_local std::vector<Vector2d> flat;
    flat.clear();
    for (const Vector3d& p : ring) flat.emplace_back(*view * (p - v));
    if (!covers_once(flat)) return std::nullopt;
    const Vector3d& q = ring[target];
    const Vector2d& q_flat = flat[target];
    double most = -1;                          // squared, over the crossings; below 0 while the place of v is not found
    for (std::size_t j = 1; j + 1 < n; ++j) {  // the new triangles (q, ring[a], ring[b])
        const std::size_t a = (target + j) % n, b = (target + j + 1) % n;
        const Vector2d u = flat[a] - q_flat, w = flat[b] - q_flat;
        const double area = cross(u, w);
        if (!(area > 0)) return std::nullopt;
        const double of_a = cross(-q_flat, w) / area, of_b = cross(u, -q_flat) / area;
        if (of_a < -1e-12 || of_b < -1e-12 || of_a + of_b > 1 + 1e-12) continue;
        most = std::max(most, (q + of_a * (ring[a] - q) + of_b * (ring[b] - q) - v).squaredNorm());
    }
    if (most < 0) return std::nullopt;
    for (std::size_t j = 2; j + 1 < n; ++j) {  // the new inner edges (q, ring[a]); the old ones are (v, ring[i])
        const std::size_t a = (target + j) % n;
        const Vector2d u = flat[a] - q_flat;
        for (std::size_t i = 0; i < n; ++i) {
            if (i == a || i == target) continue;
            const double turn = cross(flat[i], u);
            if (turn == 0) continue;  // along each other: they meet at v or at an end
            const double along_old = cross(q_flat, u) / turn, along_new = cross(q_flat, flat[i]) / turn;
            if (along_old < 0 || along_old > 1 || along_new < 0 || along_new > 1) continue;
            most = std::max(most, (v + along_old * (ring[i] - v) - q - along_new * (ring[a] - q)).squaredNorm());
        }
    }
    return std::sqrt(most);
}

}  // namespace planlight
