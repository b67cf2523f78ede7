#include "tests/registration/matching/trial_objects.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace planlight::test {
namespace {

using Eigen::Vector3d;

/// A mesh of the surface at `radius(direction) * direction`, on a cube's six faces blown up to a sphere.
TrialSurface blown_up(double edge_mm, double largest_mm, const std::function<double(const Vector3d&)>& radius) {
    const int n = std::max(8, static_cast<int>(std::numbers::pi / 2 * largest_mm / edge_mm));
    TriangleMesh mesh;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        const double side = face % 2 == 0 ? 1 : -1;
        const auto first = static_cast<std::int32_t>(mesh.vertices_in_ct.size());
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i) {
                Vector3d d = side * Vector3d::Unit(axis);
                d[(axis + 1) % 3] = side * std::tan((2. * i / n - 1) * std::numbers::pi / 4);
                d[(axis + 2) % 3] = std::tan((2. * j / n - 1) * std::numbers::pi / 4);
                d.normalize();
                mesh.vertices_in_ct.emplace_back(radius(d) * d);
            }
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const auto a = first + j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
                mesh.triangles.push_back({a, b, d});
                mesh.triangles.push_back({a, d, c});
            }
    }
    return TrialSurface(std::move(mesh));
}

}  // namespace

TrialSurface sphere_object(double radius_mm) {
    return blown_up(2, radius_mm, [=](const Vector3d&) { return radius_mm; });
}

TrialSurface cylinder_object(double radius_mm, double height_mm) {
    return blown_up(2, height_mm / 2, [=](const Vector3d& d) {
        // Superellipsoid of power 8 along z: straight sides, rounded rims.
        const double across = std::hypot(d.x(), d.y()) / radius_mm, along = std::abs(d.z()) / (height_mm / 2);
        return std::pow(std::pow(across, 8) + std::pow(along, 8), -1. / 8);
    });
}

TrialSurface egg_object(const Vector3d& half_axes_mm) {
    return blown_up(2, half_axes_mm.maxCoeff(),
                    [=](const Vector3d& d) { return 1 / d.cwiseQuotient(half_axes_mm).norm(); });
}

TrialSurface lump_object(double radius_mm, unsigned seed) {
    struct Wave {
        Vector3d k;
        double phase, height;
    };
    std::mt19937 random(seed);
    std::normal_distribution<double> any;
    std::vector<Wave> waves;
    for (int i = 0; i < 12; ++i) {
        const double x = any(random), y = any(random), z = any(random), phase = 6 * any(random);
        const Vector3d k = 3 * Vector3d(x, y, z);
        waves.push_back({k, phase, 0.25 / (1 + 0.5 * k.norm())});
    }
    return blown_up(2, radius_mm, [=](const Vector3d& d) {
        double sum = 0;
        for (const Wave& w : waves) sum += w.height * std::cos(w.k.dot(d) + w.phase);
        return radius_mm * (1 + std::clamp(sum, -0.25, 0.25));
    });
}

}  // namespace planlight::test
