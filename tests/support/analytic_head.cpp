#include "tests/support/analytic_head.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>

namespace planlight::test {
namespace {

using Eigen::Vector3d;

struct Ball {
    Vector3d centre, half_axes;
};

// x: left, y: posterior, z: superior.
const std::array<Ball, 9> kBalls{{
    {{0, 10, 25}, {76, 96, 84}},     // skull
    {{2, -42, -48}, {50, 48, 56}},   // face
    {{1, -92, -38}, {13, 17, 24}},   // nose
    {{3, -76, -88}, {22, 20, 18}},   // chin
    {{79, 12, -12}, {10, 17, 28}},   // left ear
    {{-77, 15, -7}, {9, 15, 24}},    // right ear, smaller, higher
    {{32, -78, 8}, {24, 12, 9}},     // left brow
    {{-30, -78, 6}, {24, 11, 9}},    // right brow
    {{-38, -52, 62}, {18, 14, 20}},  // a swelling right of the forehead
}};

double ball_distance(const Ball& ball, const Vector3d& p) {
    const Vector3d q = (p - ball.centre).cwiseQuotient(ball.half_axes);
    const double k0 = q.norm();
    const double k1 = q.cwiseQuotient(ball.half_axes).norm();
    return k1 < 1e-9 ? -ball.half_axes.minCoeff() : k0 * (k0 - 1) / k1;
}

}  // namespace

double analytic_head_distance(const Vector3d& p_in_ct) {
    constexpr double kBlend_mm = 8;  // smooth union: -h log(sum exp(-d/h))
    std::array<double, kBalls.size()> d{};
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = ball_distance(kBalls[i], p_in_ct);
    const double least = *std::min_element(d.begin(), d.end());
    double sum = 0;
    for (const double di : d) sum += std::exp(-(di - least) / kBlend_mm);
    const double head = least - kBlend_mm * std::log(sum);
    const double dent = ball_distance({{28, -108, 52}, {26, 22, 26}}, p_in_ct);  // left of the forehead
    const double carve = 3;
    const double h = std::max(carve - std::abs(head + dent), 0.0) / carve;
    return std::max(head, -dent) + h * h * carve / 4;
}

Vector3d analytic_head_normal(const Vector3d& p_in_ct) {
    constexpr double kStep_mm = 1e-3;
    Vector3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
        const Vector3d step = kStep_mm * Vector3d::Unit(axis);
        gradient[axis] = analytic_head_distance(p_in_ct + step) - analytic_head_distance(p_in_ct - step);
    }
    return gradient.normalized();
}

Vector3d on_analytic_head(const Vector3d& p_in_ct) {
    Vector3d p = p_in_ct;
    for (int i = 0; i < 60; ++i) {
        constexpr double kStep_mm = 1e-3;
        const double d = analytic_head_distance(p);
        if (std::abs(d) < 1e-9) break;
        const Vector3d n = analytic_head_normal(p);
        const double slope =
            (analytic_head_distance(p + kStep_mm * n) - analytic_head_distance(p - kStep_mm * n)) / (2 * kStep_mm);
        p -= std::clamp(d / std::max(slope, 0.2), -5.0, 5.0) * n;
    }
    return p;
}

TriangleMesh analytic_head_mesh(double edge_mm) {
    // Naive surface nets (Gibson 1998) on a grid, then Newton onto the surface: closed because the head lies inside the
    // grid.
    const Vector3d low(-105, -135, -125), high(105, 125, 130);
    const Eigen::Vector3i n = ((high - low) / edge_mm).array().ceil().cast<int>() + 1;
    const auto at = [&](int i, int j, int k) { return Vector3d(low + edge_mm * Vector3d(i, j, k)); };
    const auto index = [&](int i, int j, int k) {
        return (static_cast<std::size_t>(k) * static_cast<std::size_t>(n.y()) + static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(n.x()) +
               static_cast<std::size_t>(i);
    };
    std::vector<float> field(index(0, 0, n.z()));
    for (int k = 0; k < n.z(); ++k)
        for (int j = 0; j < n.y(); ++j)
            for (int i = 0; i < n.x(); ++i)
                field[index(i, j, k)] = static_cast<float>(analytic_head_distance(at(i, j, k)));
    TriangleMesh mesh;
    std::map<std::size_t, std::int32_t> vertex_of_cell;
    for (int k = 0; k + 1 < n.z(); ++k)
        for (int j = 0; j + 1 < n.y(); ++j)
            for (int i = 0; i + 1 < n.x(); ++i) {
                int in = 0;
                for (int c = 0; c < 8; ++c) in += field[index(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2))] < 0;
                if (in == 0 || in == 8) continue;
                const Vector3d p = on_analytic_head(at(i, j, k) + Vector3d::Constant(edge_mm / 2));
                vertex_of_cell[index(i, j, k)] = static_cast<std::int32_t>(mesh.vertices_in_ct.size());
                mesh.vertices_in_ct.push_back(p);
                mesh.normals_in_ct.push_back(analytic_head_normal(p));
            }
    const auto quad = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d, bool flip) {
        const std::int32_t va = vertex_of_cell.at(a), vb = vertex_of_cell.at(b), vc = vertex_of_cell.at(c),
                           vd = vertex_of_cell.at(d);
        if (flip) {
            mesh.triangles.push_back({va, vc, vb});
            mesh.triangles.push_back({va, vd, vc});
        } else {
            mesh.triangles.push_back({va, vb, vc});
            mesh.triangles.push_back({va, vc, vd});
        }
    };
    for (int k = 1; k + 1 < n.z(); ++k)
        for (int j = 1; j + 1 < n.y(); ++j)
            for (int i = 1; i + 1 < n.x(); ++i) {
                const bool in = field[index(i, j, k)] < 0;
                if (in != (field[index(i + 1, j, k)] < 0))
                    quad(index(i, j - 1, k - 1), index(i, j, k - 1), index(i, j, k), index(i, j - 1, k), !in);
                if (in != (field[index(i, j + 1, k)] < 0))
                    quad(index(i - 1, j, k - 1), index(i - 1, j, k), index(i, j, k), index(i, j, k - 1), !in);
                if (in != (field[index(i, j, k + 1)] < 0))
                    quad(index(i - 1, j - 1, k), index(i, j - 1, k), index(i, j, k), index(i - 1, j, k), !in);
            }
    return mesh;
}

SkinLut analytic_head_lut(double voxel_mm, double margin_mm) {
    const TriangleMesh mesh = analytic_head_mesh(voxel_mm);
    SkinLut lut;
    Vector3d low = mesh.vertices_in_ct.front(), high = low;
    for (const auto& v : mesh.vertices_in_ct) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    lut.voxel_mm = lut.distance_voxel_mm = voxel_mm;
    lut.origin_in_ct = low - Vector3d::Constant(margin_mm);
    const Eigen::Vector3i n =
        ((high - low + Vector3d::Constant(2 * margin_mm)) / voxel_mm).array().ceil().cast<int>() + 1;
    lut.size = lut.distance_size = {n.x(), n.y(), n.z()};
    const auto index = [&](const Eigen::Vector3i& v) {
        return (static_cast<std::size_t>(v.z()) * static_cast<std::size_t>(n.y()) + static_cast<std::size_t>(v.y())) *
                   static_cast<std::size_t>(n.x()) +
               static_cast<std::size_t>(v.x());
    };
    const std::size_t count = index({0, 0, n.z()});
    constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    lut.nearest.assign(count, kNone);
    lut.distance_mm.resize(count);
    for (std::size_t i = 0; i < mesh.vertices_in_ct.size(); ++i) {
        const Vector3d& p = mesh.vertices_in_ct[i];
        const Eigen::Vector3i v = ((p - lut.origin_in_ct) / voxel_mm).array().round().cast<int>();
        auto& pointer = lut.nearest[index(v)];
        if (pointer != kNone) continue;
        pointer = static_cast<std::uint32_t>(lut.skin.size());
        lut.skin.push_back(
            {p.cast<float>(),
             mesh.normals_in_ct[i].cast<float>(),
             {static_cast<std::uint16_t>(v.x()), static_cast<std::uint16_t>(v.y()), static_cast<std::uint16_t>(v.z())},
             0});
    }
    // Pointers spread from voxel to voxel until none improves (vector distance propagation, swept to a fixed point).
    const auto squared = [&](const Eigen::Vector3i& v, std::uint32_t s) {
        const auto& w = lut.skin[s].voxel;
        return (v - Eigen::Vector3i(w[0], w[1], w[2])).squaredNorm();
    };
    for (bool changed = true; changed;) {
        changed = false;
        for (int sweep = 0; sweep < 8; ++sweep)
            for (int kk = 0; kk < n.z(); ++kk)
                for (int jj = 0; jj < n.y(); ++jj)
                    for (int ii = 0; ii < n.x(); ++ii) {
                        const Eigen::Vector3i v((sweep & 1) ? n.x() - 1 - ii : ii, (sweep & 2) ? n.y() - 1 - jj : jj,
                                                (sweep & 4) ? n.z() - 1 - kk : kk);
                        auto& mine = lut.nearest[index(v)];
                        for (int axis = 0; axis < 3; ++axis) {
                            Eigen::Vector3i w = v;
                            w[axis] += (sweep >> axis) & 1 ? 1 : -1;
                            if (w[axis] < 0 || w[axis] >= n[axis]) continue;
                            const auto theirs = lut.nearest[index(w)];
                            if (theirs == kNone) continue;
                            if (mine == kNone || squared(v, theirs) < squared(v, mine)) {
                                mine = theirs;
                                changed = true;
                            }
                        }
                    }
    }
    for (int k = 0; k < n.z(); ++k)
        for (int j = 0; j < n.y(); ++j)
            for (int i = 0; i < n.x(); ++i) {
                const Vector3d p = lut.origin_in_ct + voxel_mm * Vector3d(i, j, k);
                const auto& s = lut.skin[lut.nearest[index({i, j, k})]];
                const double far = (s.position_in_ct.cast<double>() - p).norm();
                const double sign = analytic_head_distance(p) < 0 ? -1 : 1;
                // Near the surface the tangent plane behind the pointer is far better than the distance to the point.
                const double plane = s.normal_in_ct.cast<double>().dot(p - s.position_in_ct.cast<double>());
                lut.distance_mm[index({i, j, k})] = static_cast<float>(far < 3 * voxel_mm ? plane : sign * far);
            }
    return lut;
}

PointCloud view_of_analytic_head(const Vector3d& eye_in_ct, double width_mm, int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> offset(-width_mm / 2, width_mm / 2);
    const Vector3d forward = -eye_in_ct.normalized();
    const Vector3d right = forward.unitOrthogonal(), down = forward.cross(right);
    PointCloud cloud;
    for (int tries = 0; tries < 20 * count && static_cast<int>(cloud.size()) < count; ++tries) {
        const Vector3d towards = offset(random) * right + offset(random) * down;
        const Vector3d direction = (towards - eye_in_ct).normalized();
        Vector3d p = eye_in_ct + direction * std::max(eye_in_ct.norm() - 200, 0.0);
        double d = analytic_head_distance(p);
        for (int i = 0; i < 400 && d > 1e-7 && (p - eye_in_ct).norm() < eye_in_ct.norm() + 200; ++i) {
            p += 0.6 * std::min(d, 20.0) * direction;
            d = analytic_head_distance(p);
        }
        if (d > 1e-5) continue;
        const Vector3d n = analytic_head_normal(p);
        if (n.dot(direction) > -0.25) continue;
        cloud.points_in_rig.push_back(p);
        cloud.normals_in_rig.push_back(n);
    }
    return cloud;
}

}  // namespace planlight::test
