#include "tests/registration/scan/solid_optics.h"

#include <algorithm>
#include <cmath>

namespace planlight::solid_room {

Vector3d normal_at(const Solid& solid, const Vector3d& p) {
    constexpr double e = 0.02;
    Vector3d n;
    for (int k = 0; k < 3; ++k) n[k] = solid(p + e * Vector3d::Unit(k)) - solid(p - e * Vector3d::Unit(k));
    return n.normalized();
}

std::optional<double> march(const Solid& solid, const Vector3d& from, const Vector3d& way, double begin, double end) {
    double t = begin;
    for (int step = 0; step < 200 && t < end; ++step) {
        const double d = solid(from + t * way);
        if (d < 0.01) return t;
        t += std::max(d, 0.02);
    }
    return std::nullopt;
}

Vector3d eye_of(const Device& d) {
    return d.device_from_room.inverse().translation();
}

std::optional<Eigen::Vector2d> pixel_of(const Device& d, const Vector3d& p) {
    const Vector3d q = d.device_from_room * p;
    if (q.z() <= 1) return std::nullopt;
    const double x = q.x() / q.z(), y = q.y() / q.z(), bent = 1 + d.k1 * (x * x + y * y);
    return Eigen::Vector2d(d.focal * x * bent + d.centre_x, d.focal * y * bent + d.centre_y);
}

Vector3d way_of(const Device& d, double px, double py) {
    const double X = (px - d.centre_x) / d.focal, Y = (py - d.centre_y) / d.focal;
    double x = X, y = Y;
    for (int k = 0; k < 20; ++k) {
        const double bent = 1 + d.k1 * (x * x + y * y);
        x = X / bent, y = Y / bent;
    }
    return (d.device_from_room.linear().transpose() * Vector3d(x, y, 1)).normalized();
}

std::optional<Lit> lit_at(const Room& room, const Vector3d& p, const Vector3d& normal) {
    const Vector3d lamp = eye_of(room.projector), to = p - lamp;
    const double away = to.norm(), facing = -normal.dot(to) / away;
    if (facing <= 0) return std::nullopt;
    const auto pixel = pixel_of(room.projector, p);
    if (!pixel || pixel->x() < -2 || pixel->y() < -2 || pixel->x() > room.projector.width + 1 ||
        pixel->y() > room.projector.height + 1)
        return std::nullopt;
    const auto first = march(room.solid, lamp, to / away, 50, away);
    if (first && *first < away - 0.3) return std::nullopt;
    return Lit{*pixel, facing * 360000 / (away * away)};
}

}  // namespace planlight::solid_room
