#include "app/report/plan_facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning_io/files/xml_text.h"
#include "projection/check_items.h"
#include "projection/skin_surface.h"

namespace planlight {

using Eigen::Vector3d;

namespace {

constexpr double kOnSkin_mm = 0.5, kLook_mm = 2;

double degrees(double radians) {
    return radians * 180 / std::numbers::pi;
}

/// The table, and the surface that it was made from, where there is one.
struct Skin {
    const SkinLut& lut;
    const SkinSurface* surface;
};

/// The skin's outward direction where the item is drawn, over 8 mm round (that of a single place is a voxel's, with its
/// noise); empty where the table does not reach.
std::optional<Vector3d> outwards_at(const Skin& skin, const Vector3d& p_in_ct) {
    constexpr double kRound_mm = 8;
    if (skin.surface) return skin.surface->mean_normal(skin.surface->nearest(p_in_ct), kRound_mm);
    const SkinPoint* point = skin.lut.nearest_skin(p_in_ct);
    return point ? std::optional(Vector3d(point->normal_in_ct.cast<double>())) : std::nullopt;
}

std::optional<double> tilt_of(const Skin& skin, const Vector3d& at, const Vector3d& inwards) {
    const auto outwards = outwards_at(skin, at);
    if (!outwards || inwards.norm() < 1e-9) return std::nullopt;
    return std::acos(std::clamp(-inwards.normalized().dot(outwards->normalized()), -1.0, 1.0));
}

/// Of a line's own points; of anything else its place on the skin.
Vector3d middle_of(const PlanDrawing& drawing, std::size_t item, StrokeKind kind) {
    const bool line = kind == StrokeKind::osteotomy_line || kind == StrokeKind::cut_plane;
    Vector3d sum = Vector3d::Zero();
    double count = 0;
    for (const Stroke& stroke : drawing.strokes) {
        if (!line || stroke.item != static_cast<int>(item) || stroke.kind != kind) continue;
        for (const Vector3d& p : stroke.points_in_ct) sum += p, ++count;
    }
    return count > 0 ? Vector3d(sum / count) : drawing.items[item].anchor_in_ct;
}

/// All strokes of that kind that belong to the item; ticks and labels do not.
double length_along_skin_mm(const PlanDrawing& drawing, std::size_t item, StrokeKind kind) {
    double sum = 0;
    for (const Stroke& stroke : drawing.strokes) {
        if (stroke.item != static_cast<int>(item) || stroke.kind != kind) continue;
        const auto& points = stroke.points_in_ct;
        for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
        if (stroke.closed) sum += (points.front() - points.back()).norm();
    }
    return sum;
}

void tell(PlanFact& fact, const OsteotomyLine& line, const DrawnItem&, const Skin&) {
    fact.kind = line.closed ? "closed line" : "open line";
}

void tell(PlanFact& fact, const Borehole& hole, const DrawnItem& item, const Skin& skin) {
    fact.kind = "borehole";
    if (hole.depth_mm > 0) fact.depth_mm = hole.depth_mm;
    if (hole.diameter_mm > 0) fact.diameter_mm = hole.diameter_mm;
    if (!hole.axis_in_ct) {
        fact.tilt = 0;  // along the skin's own perpendicular
    } else {
        fact.tilt = tilt_of(skin, item.anchor_in_ct, *hole.axis_in_ct);
        fact.inwards_in_ct = hole.axis_in_ct->normalized();
    }
}

void tell(PlanFact& fact, const Trajectory& t, const DrawnItem& item, const Skin& skin) {
    fact.kind = "trajectory";
    fact.depth_mm = t.length_mm();
    if (t.diameter_mm > 0) fact.diameter_mm = t.diameter_mm;
    if (!(t.length_mm() > 1e-6)) return;
    fact.inwards_in_ct = (t.target_in_ct - t.entry_in_ct) / t.length_mm();
    fact.tilt = tilt_of(skin, item.anchor_in_ct, *fact.inwards_in_ct);
}

void tell(PlanFact& fact, const CutPlane& plane, const DrawnItem& item, const Skin& skin) {
    fact.kind = "cut plane";
    const auto outwards = outwards_at(skin, item.anchor_in_ct);
    if (outwards) fact.tilt = std::asin(std::clamp(std::abs(plane.normal_in_ct.dot(*outwards)), 0.0, 1.0));
}

void tell_of_skin(PlanFact& fact, const DrawnItem& item, const SkinLut& lut) {
    fact.to_skin_mm = item.distance_to_skin_mm;
    fact.gravity = gravity_of(item.distance_to_skin_mm);
    fact.distance = distance_in_words(item.distance_to_skin_mm);
    const bool point = item.kind == StrokeKind::borehole || item.kind == StrokeKind::trajectory;
    const SkinPoint* skin = lut.nearest_skin(item.anchor_in_ct);
    if (point && skin && std::isfinite(skin->thickness_mm)) fact.over_bone_mm = skin->thickness_mm;
}

}  // namespace

Gravity gravity_of(double mm, const DrawingSettings& settings) {
    if (!(mm <= kTooFarFactor * settings.max_distance_to_skin_mm)) return Gravity::stop;
    return mm > kLook_mm ? Gravity::look : Gravity::none;
}

const char* class_of(Gravity gravity) {
    return gravity == Gravity::stop ? "stop" : gravity == Gravity::look ? "look" : "";
}

Gravity gravity_of(const Clearances& clearances) {
    if (clearances.empty() || !warns(clearances.front())) return Gravity::none;
    return clearances.front().through ? Gravity::stop : Gravity::look;
}

std::string risk_in_words(const Clearances& clearances) {
    if (clearances.empty()) return "–";
    std::string words = clearance_in_words(clearances.front());
    for (std::size_t i = 1; i < clearances.size() && warns(clearances[i]); ++i)
        words += "; " + clearance_in_words(clearances[i]);
    if (clearances.front().through) return words;
    return warns(clearances.front()) ? words + ": near" : words;
}

std::string risk_html(const Clearances& clearances) {
    std::string html = xml_escaped(risk_in_words(clearances));
    static const std::string kUnit = " mm to ";
    for (std::size_t at = html.find(kUnit); at != std::string::npos; at = html.find(kUnit, at))
        html.replace(at, kUnit.size(), "&nbsp;mm to ");
    return fmt::format("<span class=\"{}\">{}</span>", class_of(gravity_of(clearances)), html);
}

std::string distance_in_words(double mm, const DrawingSettings& settings) {
    if (!std::isfinite(mm)) return "not known";
    if (mm <= kOnSkin_mm) return "on the skin";
    if (gravity_of(mm, settings) == Gravity::stop) return fmt::format("{:.1f} mm off the skin: not drawn", mm);
    if (mm > settings.max_distance_to_skin_mm) return fmt::format("{:.1f} mm off the skin: far; drawn on the skin", mm);
    if (mm > kLook_mm) return fmt::format("{:.1f} mm off the skin; drawn on the skin", mm);
    return fmt::format("{:.1f} mm off the skin", mm);
}

std::string direction_in_words(const Vector3d& inwards_in_ct) {
    const double aside = degrees(std::asin(std::clamp(inwards_in_ct.x(), -1.0, 1.0))),
                 up = degrees(std::asin(std::clamp(inwards_in_ct.z(), -1.0, 1.0)));
    const auto words = [](double angle, const char* minus, const char* plus) {
        return std::abs(angle) < 0.5 ? std::string()
                                     : fmt::format("{:.0f}° {}", std::abs(angle), angle < 0 ? minus : plus);
    };
    const std::string sideways = words(aside, "to the right", "to the left"), upwards = words(up, "down", "up");
    if (sideways.empty() && upwards.empty()) return inwards_in_ct.y() > 0 ? "straight back" : "straight forward";
    return sideways + (sideways.empty() || upwards.empty() ? "" : ", ") + upwards;
}

std::string side_in_words(double left_of_middle_mm) {
    constexpr double kMiddle_mm = 2;
    if (std::abs(left_of_middle_mm) < kMiddle_mm) return "in the middle";
    return fmt::format("{:.0f} mm {}", std::abs(left_of_middle_mm), left_of_middle_mm > 0 ? "left" : "right");
}

std::vector<PlanFact> plan_facts(const Plan& plan, const PlanDrawing& drawing, const SkinLut& lut,
                                 const std::optional<MidPlane>& mid_plane, const SkinSurface* surface) {
    std::vector<PlanFact> facts;
    const auto add = [&](const auto& items, StrokeKind kind, bool has_length) {
        for (const auto& item : items) {
            const std::size_t number = facts.size();
            if (number >= drawing.items.size()) return;
            PlanFact fact;
            fact.name = item.name;
            if (drawing.items[number].lit_by_code) fact.lit = drawing.items[number].lit_name;
            tell(fact, item, drawing.items[number], Skin{lut, surface});
            if (const double mm = length_along_skin_mm(drawing, number, kind); has_length && mm > 0)
                fact.length_mm = mm;
            tell_of_skin(fact, drawing.items[number], lut);
            fact.clearances = drawing.items[number].clearances;
            if (mid_plane) fact.left_of_middle_mm = mid_plane->left_mm(middle_of(drawing, number, kind));
            facts.push_back(std::move(fact));
        }
    };
    add(plan.osteotomy_lines, StrokeKind::osteotomy_line, true);
    add(plan.boreholes, StrokeKind::borehole, false);
    add(plan.trajectories, StrokeKind::trajectory, false);
    add(plan.cut_planes, StrokeKind::cut_plane, true);
    return facts;
}

}  // namespace planlight
