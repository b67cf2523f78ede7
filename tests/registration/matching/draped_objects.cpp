#include "tests/registration/matching/draped_objects.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace planlight::test {

using Eigen::Vector3d;

TriangleMesh sheet_mesh(const Height& height, double width_mm, double edge_mm) {
    const int n = static_cast<int>(width_mm / edge_mm) + 1;
    TriangleMesh mesh;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const double x = i * edge_mm - width_mm / 2, y = j * edge_mm - width_mm / 2;
            mesh.vertices_in_ct.emplace_back(x, y, height(x, y));
        }
    const auto there = [&](std::int32_t v) {
        return std::isfinite(mesh.vertices_in_ct[static_cast<std::size_t>(v)].z());
    };
    for (int j = 0; j + 1 < n; ++j)
        for (int i = 0; i + 1 < n; ++i) {
            const std::int32_t a = j * n + i, b = a + 1, c = a + n, d = c + 1;
            if (there(a) && there(b) && there(d)) mesh.triangles.push_back({a, b, d});
            if (there(a) && there(d) && there(c)) mesh.triangles.push_back({a, d, c});
        }
    for (Vector3d& p : mesh.vertices_in_ct)
        if (!p.allFinite()) p.z() = -2000;  // of no triangle
    return mesh;
}

TriangleMesh pipe_mesh(const std::vector<Vector3d>& line, const std::vector<double>& radius_mm) {
    constexpr int kRound = 28, kCap = 6;
    std::vector<Vector3d> centres;
    std::vector<double> radii;
    const auto cap = [&](const Vector3d& end, const Vector3d& out, double radius, bool first) {
        for (int k = 0; k <= kCap; ++k) {
            const double a = (first ? kCap - k : k) * std::numbers::pi / 2 / kCap;
            centres.push_back(end + radius * std::sin(a) * out);
            radii.push_back(std::max(1e-3, radius * std::cos(a)));
        }
    };
    const std::size_t last = line.size() - 1;
    cap(line[0], (line[0] - line[1]).normalized(), radius_mm[0], true);
    for (std::size_t i = 1; i < last; ++i) {
        centres.push_back(line[i]);
        radii.push_back(radius_mm[i]);
    }
    cap(line[last], (line[last] - line[last - 1]).normalized(), radius_mm[last], false);
    TriangleMesh mesh;
    Vector3d side = (line[1] - line[0]).unitOrthogonal();
    for (std::size_t i = 0; i < centres.size(); ++i) {
        const Vector3d before = centres[i == 0 ? 0 : i - 1], after = centres[std::min(i + 1, centres.size() - 1)];
        const Vector3d along = (after - before).normalized();
        side = (side - side.dot(along) * along).normalized();
        const Vector3d across = along.cross(side);
        for (int k = 0; k < kRound; ++k) {
            const double a = 2 * std::numbers::pi * k / kRound;
            mesh.vertices_in_ct.emplace_back(centres[i] + radii[i] * (std::cos(a) * side + std::sin(a) * across));
        }
    }
    for (int i = 0; i + 1 < static_cast<int>(centres.size()); ++i)
        for (int k = 0; k < kRound; ++k) {
            const int a = i * kRound + k, b = i * kRound + (k + 1) % kRound, c = a + kRound, d = b + kRound;
            mesh.triangles.push_back({a, b, d});
            mesh.triangles.push_back({a, d, c});
        }
    return mesh;
}

TriangleMesh box_mesh(const Vector3d& middle, const Eigen::Matrix3d& axes, const Vector3d& size_mm) {
    TriangleMesh mesh;
    for (int c = 0; c < 8; ++c) {
        const Vector3d corner(c & 1 ? 0.5 : -0.5, c & 2 ? 0.5 : -0.5, c & 4 ? 0.5 : -0.5);
        mesh.vertices_in_ct.emplace_back(middle + axes * corner.cwiseProduct(size_mm));
    }
    for (const auto& q : std::vector<std::array<std::int32_t, 4>>{
             {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
        mesh.triangles.push_back({q[0], q[1], q[2]});
        mesh.triangles.push_back({q[0], q[2], q[3]});
    }
    return mesh;
}

void append(const TriangleMesh& part, TriangleMesh& to) {
    const auto first = static_cast<std::int32_t>(to.vertices_in_ct.size());
    to.vertices_in_ct.insert(to.vertices_in_ct.end(), part.vertices_in_ct.begin(), part.vertices_in_ct.end());
    for (const auto& t : part.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

Folds::Folds(double shortest_mm, double longest_mm, double height_mm, std::mt19937& random) {
    constexpr int kWaves = 7;
    std::uniform_real_distribution<double> unit;
    for (int i = 0; i < kWaves; ++i) {
        const double length_mm = shortest_mm * std::pow(longest_mm / shortest_mm, unit(random));
        const double way = 2 * std::numbers::pi * unit(random), phase = 2 * std::numbers::pi * unit(random);
        const double k = 2 * std::numbers::pi / length_mm;
        // Short folds are lower: no cloth is steeper than it can hang.
        const double steep = std::min(1., 0.15 * length_mm / std::max(height_mm, 1e-9));
        waves_.push_back({k * std::cos(way), k * std::sin(way), phase, steep * height_mm * std::sqrt(2. / kWaves)});
    }
}

double Folds::operator()(double x, double y) const {
    double sum = 0;
    for (const Wave& w : waves_) sum += w.height_mm * std::sin(w.kx * x + w.ky * y + w.phase);
    return sum;
}

}  // namespace planlight::test
