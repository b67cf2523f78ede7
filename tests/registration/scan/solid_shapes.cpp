#include <algorithm>
#include <cmath>

#include "tests/registration/scan/solid_room.h"

namespace planlight::solid_room {
namespace {

double smooth_min(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - h * h * k / 4;
}

/// A lower bound of the distance to an ellipsoid.
double ellipsoid(const Vector3d& p, const Vector3d& half) {
    const double k0 = p.cwiseQuotient(half).norm(), k1 = p.cwiseQuotient(half.cwiseProduct(half)).norm();
    return k0 < 1 ? (k0 - 1) * half.minCoeff() : k0 * (k0 - 1) / k1;
}

/// A ring of radius R and thickness r about z, in a plane.
double ring(const Vector3d& p, double R, double r) {
    return std::hypot(std::hypot(p.x(), p.y()) - R, p.z()) - r;
}

}  // namespace

Solid ball(const Vector3d& centre, double radius_mm) {
    return [=](const Vector3d& p) { return (p - centre).norm() - radius_mm; };
}

Solid wall(const Vector3d& point, const Vector3d& normal) {
    return [=, n = Vector3d(normal.normalized())](const Vector3d& p) { return n.dot(p - point); };
}

Solid head(const Vector3d& centre) {
    return [=](const Vector3d& at) {
        const Vector3d p = at - centre;
        double d = ellipsoid(p, {72, 95, 85});
        d = smooth_min(d, ellipsoid(p - Vector3d(0, 10, -85), {11, 26, 20}), 12);  // nose
        d = smooth_min(d, ellipsoid(p - Vector3d(0, -22, -76), {45, 9, 9}), 16);   // brow
        for (const double side : {-1.0, 1.0}) {
            const Vector3d q = Eigen::AngleAxisd(side * 0.9, Vector3d::UnitY()) * (p - Vector3d(side * 76, 5, -22));
            d = smooth_min(d, ring(Vector3d(q.x(), q.y() * 0.65, q.z()), 17, 2.2) * 0.65, 3);  // rim of the ear
            d = smooth_min(d, ring(Vector3d(q.x() + 2, q.y() * 0.7, q.z()), 9, 2) * 0.7, 3);
        }
        return 0.8 * d;
    };
}

Solid shell(const Vector3d& centre) {
    std::vector<std::pair<Vector3d, double>> whorls;
    for (int k = 0; k < 70; ++k) {
        const double turn = 0.31 * k, size = std::exp(-0.034 * k);
        whorls.push_back(
            {centre + Vector3d(-48 + 105 * (1 - size), 21 * size * std::cos(turn), 21 * size * std::sin(turn)),
             23 * size});
    }
    return [=](const Vector3d& p) {
        double d = 1e9;
        for (const auto& [c, r] : whorls) d = std::min(d, (p - c).norm() - r);
        const Vector3d q = p - centre;
        const double ribs = 1.0 * std::pow(std::abs(std::sin(0.22 * (q.x() + 0.7 * q.y()))), 6.0);  // thin, 14 mm apart
        const double body = (d - ribs) * 0.7;
        const double mouth =
            ellipsoid(Vector3d(Eigen::AngleAxisd(0.5, Vector3d::UnitZ()) * (q - Vector3d(-40, 4, -34))), {22, 10, 26});
        return std::max(body, -mouth);
    };
}

Solid folds(const Vector3d& centre, double depth_mm) {
    constexpr double kApart = 14, kThick = 1.5;
    return [=](const Vector3d& at) {
        const Vector3d p = at - centre;
        const auto box = [](const Vector3d& q, const Vector3d& half) {
            const Vector3d o = q.cwiseAbs() - half;
            return o.cwiseMax(0.0).norm() + std::min(o.maxCoeff(), 0.0);
        };
        double d = box(p - Vector3d(0, 0, 10), {60, 45, 10});
        const double nearest = std::clamp(std::round(p.x() / kApart), -4.0, 4.0) * kApart;
        for (const double x : {nearest - kApart, nearest, nearest + kApart})
            d = smooth_min(d, box(p - Vector3d(x, 0, -depth_mm / 2), {kThick / 2, 40, depth_mm / 2}) - 0.3, 2);
        return d;
    };
}

}  // namespace planlight::solid_room
