#include "projection/skin_paths.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace planlight {
namespace {

using Eigen::Vector3d;
using Point = SkinSurface::Point;

/// Moves the end of a way that missed its aim by `gap` onto the aim, every point by its share.
SkinLine spread_gap(const SkinSurface& skin, const std::vector<Point>& way, const Point& to) {
    const Vector3d gap = to.p_in_ct - way.back().p_in_ct;
    SkinLine line{way, false};
    const auto last = line.points.size() - 1;
    if (gap.norm() > 1e-6)
        for (std::size_t i = 1; i < last; ++i)
            line.points[i] = skin.nearest(way[i].p_in_ct + gap * (static_cast<double>(i) / static_cast<double>(last)));
    line.points.back() = to;
    return line;
}

struct Shot {
    std::vector<Point> way;
    double gap_mm = 1e300;
};

Shot shoot(const SkinSurface& skin, const Point& from, const Point& to, double max_segment_mm) {
    const Vector3d chord = to.p_in_ct - from.p_in_ct;
    Vector3d aim = chord - chord.dot(from.normal_in_ct) * from.normal_in_ct;
    if (!(aim.norm() > 1e-9)) return {};
    aim *= chord.norm() / aim.norm();
    Shot best;
    for (int tries = 0; tries < 12 && best.gap_mm > 1e-3; ++tries) {
        const auto way = skin.walk_way(from, aim, max_segment_mm);
        if (!way) break;
        const Point& end = way->points.back();
        const Vector3d gap = to.p_in_ct - end.p_in_ct;
        if (gap.norm() < best.gap_mm) best = {way->points, gap.norm()};
        // The gap seen in the frame that the way carries along (tangent, side), brought back to the start.
        const Vector3d ahead = way->direction_at_end_in_ct, aside = end.normal_in_ct.cross(ahead);
        const Vector3d start_ahead = aim.normalized(), start_aside = from.normal_in_ct.cross(start_ahead);
        aim += gap.dot(ahead) * start_ahead + gap.dot(aside) * start_aside;
        if (!(aim.norm() > 1e-6) || aim.norm() > 3 * chord.norm() + 1) break;
    }
    return best;
}

/// The chord laid onto the skin: the last resort where there is no straight way.
SkinLine laid_chord(const SkinSurface& skin, const Point& from, const Point& to, double max_segment_mm) {
    const Vector3d chord = to.p_in_ct - from.p_in_ct;
    const int n = std::max(1, static_cast<int>(std::ceil(2 * chord.norm() / max_segment_mm)));
    SkinLine line{{from}, false};
    for (int i = 1; i < n; ++i) line.points.push_back(skin.nearest(from.p_in_ct + chord * i / n));
    line.points.push_back(to);
    return line;
}

SkinLine straight_way(const SkinSurface& skin, const Point& from, const Point& to, double max_segment_mm,
                      int halvings) {
    const double chord_mm = (to.p_in_ct - from.p_in_ct).norm();
    const Shot shot = shoot(skin, from, to, max_segment_mm);
    if (shot.gap_mm < std::max(0.05, 0.02 * chord_mm)) return spread_gap(skin, shot.way, to);
    if (halvings == 0 || chord_mm < 2 * max_segment_mm) return laid_chord(skin, from, to, max_segment_mm);
    const Point middle = skin.nearest((from.p_in_ct + to.p_in_ct) / 2);
    SkinLine line = straight_way(skin, from, middle, max_segment_mm, halvings - 1);
    const SkinLine rest = straight_way(skin, middle, to, max_segment_mm, halvings - 1);
    line.points.insert(line.points.end(), rest.points.begin() + 1, rest.points.end());
    return line;
}

}  // namespace

double length_mm(const SkinLine& line) {
    double length = 0;
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i)
        length += (line.points[i + 1].p_in_ct - line.points[i].p_in_ct).norm();
    if (line.closed && line.points.size() > 1)
        length += (line.points.front().p_in_ct - line.points.back().p_in_ct).norm();
    return length;
}

SkinLine straight_way(const SkinSurface& skin, const Point& from, const Point& to, double max_segment_mm) {
    return straight_way(skin, from, to, max_segment_mm, 5);
}

SkinLine join(const SkinSurface& skin, const std::vector<Point>& points, bool closed, double max_segment_mm) {
    std::vector<Point> apart;
    for (const Point& p : points)
        if (apart.empty() || (p.p_in_ct - apart.back().p_in_ct).norm() > 1e-6) apart.push_back(p);
    if (closed && apart.size() > 1 && (apart.front().p_in_ct - apart.back().p_in_ct).norm() < 1e-6) apart.pop_back();
    SkinLine line{{}, closed && apart.size() > 2};
    if (apart.empty()) return line;
    line.points.push_back(apart.front());
    for (std::size_t i = 1; i < apart.size() + (line.closed ? 1 : 0); ++i) {
        const SkinLine leg = straight_way(skin, apart[i - 1], apart[i % apart.size()], max_segment_mm);
        line.points.insert(line.points.end(), leg.points.begin() + 1, leg.points.end());
    }
    if (line.closed) line.points.pop_back();
    return line;
}

SkinLine circle(const SkinSurface& skin, const Point& centre, double radius_mm, double max_segment_mm) {
    const double around_mm = 2 * std::numbers::pi * radius_mm;
    const int n = std::max(24, static_cast<int>(std::ceil(around_mm / max_segment_mm)));
    const Vector3d first = centre.normal_in_ct.unitOrthogonal(), second = centre.normal_in_ct.cross(first);
    SkinLine line{{}, true};
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * i / n;
        const Vector3d way = radius_mm * (std::cos(angle) * first + std::sin(angle) * second);
        const auto reached = skin.walk(centre, way);
        line.points.push_back(reached ? *reached : skin.nearest(centre.p_in_ct + way));
    }
    return line;
}

SkinLine bar(const SkinSurface& skin, const Point& centre, const Vector3d& direction_in_ct, double back_mm,
             double ahead_mm, double max_segment_mm) {
    const Vector3d tangent =
        (direction_in_ct - direction_in_ct.dot(centre.normal_in_ct) * centre.normal_in_ct).normalized();
    SkinLine line;
    const auto walk = [&](double from_mm, double to_mm) {
        const auto start = skin.walk_way(centre, from_mm * tangent, std::max(1e-6, std::abs(from_mm)));
        if (!start) return std::optional<SkinSurface::Way>();
        const double sign = from_mm < 0 ? -1 : 1;  // the way's own direction points backwards when it led backwards
        const Vector3d onward = from_mm == 0 ? tangent : Vector3d(sign * start->direction_at_end_in_ct);
        return skin.walk_way(start->points.back(), (to_mm - from_mm) * onward, max_segment_mm);
    };
    if (const auto way = walk(-back_mm, ahead_mm)) line.points = way->points;
    return line;
}

LinePlace place_along(const SkinSurface& skin, const SkinLine& line, double way_mm) {
    const std::size_t count = line.points.size(), segments = line.closed ? count : count - 1;
    double passed_mm = 0;
    for (std::size_t i = 0; i < segments; ++i) {
        const Vector3d a = line.points[i].p_in_ct, b = line.points[(i + 1) % count].p_in_ct;
        const double step_mm = (b - a).norm();
        if (passed_mm + step_mm >= way_mm || i + 1 == segments) {
            const double share = step_mm > 0 ? std::clamp((way_mm - passed_mm) / step_mm, 0.0, 1.0) : 0;
            return {skin.nearest(a + share * (b - a)), (b - a).normalized()};
        }
        passed_mm += step_mm;
    }
    return {line.points.front(), line.points.front().normal_in_ct.unitOrthogonal()};
}

}  // namespace planlight
