#include "projection/skin_place.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

using Eigen::Vector3d;
using Point = SkinSurface::Point;

/// Of the triangle itself, not unit. A smooth normal may lean the other way where the axis grazes the skin.
Vector3d face_normal(const SkinSurface& skin, int triangle) {
    const TriangleMesh& mesh = skin.mesh();
    const auto& v = mesh.triangles[static_cast<std::size_t>(triangle)];
    const auto corner = [&](std::size_t i) { return mesh.vertices_in_ct[static_cast<std::size_t>(v[i])]; };
    return (corner(1) - corner(0)).cross(corner(2) - corner(0));
}

/// The first hit, when the ray passes there `out` of the body, or into it.
std::optional<Point> passes(const SkinSurface& skin, const Vector3d& p, const Vector3d& direction, bool out) {
    constexpr double kOnIt_mm = 1e-6;
    const auto hit = skin.first_hit({p, direction});
    if (!hit) return std::nullopt;
    const double mm = (hit->p_in_ct - p).norm();
    if (mm < kOnIt_mm) return hit;
    if (mm > kMostAlong_mm || (face_normal(skin, hit->triangle).dot(direction) > 0) != out) return std::nullopt;
    return hit;
}

}  // namespace

PlaceOnSkin place_on_axis(const SkinSurface& skin, const Vector3d& p, const Vector3d& inwards) {
    // Of a closed skin one of the two at most is there. Of a surface with a border both may be.
    const auto out = passes(skin, p, -inwards, true), in = passes(skin, p, inwards, false);
    const auto mm = [&](const std::optional<Point>& hit) { return (hit->p_in_ct - p).norm(); };
    if (out && (!in || mm(out) <= mm(in))) return {*out, mm(out), 0};
    if (in) return {*in, mm(in), 0};
    const Point nearest = skin.nearest(p);
    return {nearest, 0, (nearest.p_in_ct - p).cross(inwards).norm()};
}

PlaceOnSkin place_nearest(const SkinSurface& skin, const Vector3d& p) {
    const Point nearest = skin.nearest(p);
    const Vector3d off = p - nearest.p_in_ct, aside = off - off.dot(nearest.normal_in_ct) * nearest.normal_in_ct;
    const bool beyond = aside.norm() > kToldAside_mm && !skin.walk(nearest, aside);
    return {nearest, 0, beyond ? aside.norm() : 0};
}

bool has_axis(const Borehole& hole) {
    return hole.axis_in_ct && hole.axis_in_ct->norm() > 0.5;
}

Vector3d drilling_direction(const Borehole& hole, const SkinSurface& skin) {
    constexpr double kPerpendicularOver_mm = 8;
    if (has_axis(hole)) return hole.axis_in_ct->normalized();
    return -skin.mean_normal(skin.nearest(hole.position_in_ct), kPerpendicularOver_mm);
}

PlaceOnSkin place_of(const Trajectory& t, const SkinSurface& ct_skin, const SkinSurface& skin_now) {
    const double length_mm = t.length_mm();
    const Vector3d inwards = length_mm > 1e-6 ? Vector3d((t.target_in_ct - t.entry_in_ct) / length_mm)
                                              : Vector3d(-ct_skin.nearest(t.entry_in_ct).normal_in_ct);
    return place_on_axis(skin_now, t.entry_in_ct, inwards);
}

PlaceOnSkin place_of(const Borehole& hole, const SkinSurface& ct_skin, const SkinSurface& skin_now) {
    if (has_axis(hole)) return place_on_axis(skin_now, hole.position_in_ct, hole.axis_in_ct->normalized());
    PlaceOnSkin place = place_nearest(ct_skin, hole.position_in_ct);
    place.at = skin_now.same_place(ct_skin, place.at);
    return place;
}

SkinFlag flag_at(const SkinSurface& skin, int triangle) {
    const TriangleMesh& mesh = skin.mesh();
    if (mesh.flags.size() != mesh.vertices_in_ct.size() || triangle < 0) return kSkin;
    std::uint8_t worst = kSkin;
    for (const std::int32_t v : mesh.triangles[static_cast<std::size_t>(triangle)])
        worst = std::max(worst, mesh.flags[static_cast<std::size_t>(v)]);
    return static_cast<SkinFlag>(worst);
}

std::optional<std::string> no_place(const SkinSurface& skin, const PlaceOnSkin& place, const char* what, bool axis) {
    if (place.aside_mm > kMostAside_mm)
        return axis ? fmt::format(
                          "its axis does not meet the skin within {:.0f} mm of {}; the nearest place on the skin "
                          "lies {:.1f} mm beside the axis",
                          kMostAlong_mm, what, place.aside_mm)
                    : fmt::format("{} lies {:.1f} mm beyond the border of the surface", what, place.aside_mm);
    if (flag_at(skin, place.at) == kCutPlane)
        return fmt::format("{} comes to lie on the end of the volume, where the scan ends and shows no skin", what);
    return std::nullopt;
}

LineOnSkin look_at(const SkinSurface& skin, const SkinLine& line) {
    LineOnSkin look;
    const auto& points = line.points;
    if (points.empty()) return look;
    const double each = 1 / static_cast<double>(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const SkinFlag flag = flag_at(skin, points[i]);
        look.at_end += flag == kCutPlane ? each : 0;
        look.on_lids += flag == kSeal ? each : 0;
        if (i + 1 < points.size() || line.closed)
            look.widest_step_mm =
                std::max(look.widest_step_mm, (points[(i + 1) % points.size()].p_in_ct - points[i].p_in_ct).norm());
    }
    return look;
}

RingOnSkin ring_on_skin(const SkinSurface& skin, const Point& centre, double radius_mm, double max_segment_mm) {
    const SkinLine line = circle(skin, centre, radius_mm, max_segment_mm);
    RingOnSkin ring{look_at(skin, line), 0};
    const auto& points = line.points;
    for (std::size_t i = 0; i < points.size() / 2; ++i) {
        const double across_mm = (points[i].p_in_ct - points[i + points.size() / 2].p_in_ct).norm();
        ring.narrowest = std::min(ring.narrowest, across_mm / (2 * radius_mm));
    }
    const Vector3d first = centre.normal_in_ct.unitOrthogonal(), second = centre.normal_in_ct.cross(first);
    constexpr int kWays = 48;
    for (int i = 0; i < kWays; ++i) {
        const double angle = 2 * M_PI * i / kWays;
        ring.beyond += !skin.walk(centre, radius_mm * (std::cos(angle) * first + std::sin(angle) * second));
    }
    ring.beyond /= kWays;
    return ring;
}

}  // namespace planlight
