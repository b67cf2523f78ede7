#include "projection/check_items.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace planlight {
namespace {

using Eigen::Vector3d;

/// Collects sentences that all begin with the item's name.
class Faults {
public:
    Faults(const char* kind, const std::string& name)
        : name_(name.empty() ? fmt::format("{} without a name", kind) : name) {}
    template <typename... Args>
    void add(fmt::format_string<Args...> text, Args&&... args) {
        sentences_.push_back(name_ + ": " + fmt::format(text, std::forward<Args>(args)...));
    }
    void check_distance(const char* what, double distance_mm, const DrawingSettings& s) {
        if (distance_mm > s.max_distance_to_skin_mm)
            add("{} is {:.1f} mm from the skin (at most {:.0f} mm expected){}", what, distance_mm,
                s.max_distance_to_skin_mm,
                distance_mm > kTooFarFactor * s.max_distance_to_skin_mm ? "; it is not drawn" : "");
    }
    std::vector<std::string> sentences() { return std::move(sentences_); }

private:
    std::string name_;
    std::vector<std::string> sentences_;
};

double distance_mm(const SkinSurface& skin, const Vector3d& p) {
    return (skin.nearest(p).p_in_ct - p).norm();
}

}  // namespace

bool in_the_body(const SkinSurface& skin, const Vector3d& p) {
    if (skin.inside(p)) return true;
    constexpr int kWays = 96;
    int ended = 0;
    for (int i = 0; i < kWays; ++i) {  // evenly over the sphere, along a spiral
        const double z = 1 - (2 * i + 1.0) / kWays, around = i * std::numbers::pi * (3 - std::sqrt(5.0)),
                     across = std::sqrt(1 - z * z);
        ended += skin.first_hit({p, Vector3d(across * std::cos(around), across * std::sin(around), z)}).has_value();
    }
    return 4 * ended >= 3 * kWays;
}

std::vector<std::string> faults(const Trajectory& t, const SkinSurface& skin, const DrawingSettings& s) {
    Faults f("trajectory", t.name);
    if (!finite(t)) {
        f.add("its points are not finite; it is not drawn");
        return f.sentences();
    }
    f.check_distance("its entry", distance_mm(skin, t.entry_in_ct), s);
    if (t.length_mm() < 1) f.add("entry and target are only {:.2f} mm apart", t.length_mm());
    if (!in_the_body(skin, t.target_in_ct))
        f.add("its target lies outside the body, {:.1f} mm from the skin", distance_mm(skin, t.target_in_ct));
    if (t.diameter_mm < 0) f.add("its diameter of {} mm is negative", t.diameter_mm);
    return f.sentences();
}

std::vector<std::string> faults(const Borehole& b, const SkinSurface& skin, const DrawingSettings& s) {
    Faults f("borehole", b.name);
    if (!finite(b)) {
        f.add("its numbers are not finite; it is not drawn");
        return f.sentences();
    }
    f.check_distance("its position", distance_mm(skin, b.position_in_ct), s);
    if (!(b.diameter_mm > 0)) f.add("it has no diameter; only its centre is drawn");
    if (b.diameter_mm > 60) f.add("its diameter of {:.0f} mm is larger than any drill's", b.diameter_mm);
    if (!(b.depth_mm > 0)) f.add("it has no depth");
    if (b.axis_in_ct && b.axis_in_ct->dot(skin.nearest(b.position_in_ct).normal_in_ct) > 0)
        f.add("its axis points out of the body");
    return f.sentences();
}

std::vector<std::string> faults(const OsteotomyLine& o, const SkinSurface& skin, const DrawingSettings& s) {
    Faults f("osteotomy line", o.name);
    if (!finite(o)) {
        f.add("its points are not finite; it is not drawn");
        return f.sentences();
    }
    if (o.points_in_ct.size() < 2) f.add("it has {} point(s); a line needs two", o.points_in_ct.size());
    if (o.closed && o.points_in_ct.size() == 2) f.add("it is closed but has only two points; it is drawn open");
    double far_mm = 0, way_mm = 0;
    for (std::size_t i = 0; i < o.points_in_ct.size(); ++i) {
        far_mm = std::max(far_mm, distance_mm(skin, o.points_in_ct[i]));
        if (i > 0) way_mm += (o.points_in_ct[i] - o.points_in_ct[i - 1]).norm();
    }
    f.check_distance("a point of it", far_mm, s);
    if (o.points_in_ct.size() > 1 && way_mm < 1) f.add("it is only {:.2f} mm long", way_mm);
    return f.sentences();
}

std::vector<std::string> faults(const CutPlane& c, const SkinSurface& skin, const DrawingSettings& s) {
    Faults f("cut plane", c.name);
    if (!finite(c)) {
        f.add("its numbers are not finite; it is not drawn");
        return f.sentences();
    }
    if (!(c.width_mm > 0) || !(c.height_mm > 0)) f.add("it has no extent ({} x {} mm)", c.width_mm, c.height_mm);
    if (std::abs(c.normal_in_ct.norm() - 1) > 1e-3 || std::abs(c.first_axis_in_ct.norm() - 1) > 1e-3 ||
        std::abs(c.normal_in_ct.dot(c.first_axis_in_ct)) > 1e-3)
        f.add("its axes are not unit length and square to each other; it is not drawn");
    else if (trace(skin, c, s.max_segment_mm).empty())
        f.add("it does not meet the skin within its extent of {:.0f} x {:.0f} mm", c.width_mm, c.height_mm);
    return f.sentences();
}

}  // namespace planlight
