#include "projection/draw_plan.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "projection/check_items.h"
#include "projection/plan_drawer.h"
#include "projection/skin_paths.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using Point = SkinSurface::Point;

constexpr Rgb kOsteotomyGreen{40, 255, 70};
constexpr Rgb kBoreholeCyan{0, 210, 255};
constexpr Rgb kTrajectoryAmber{255, 180, 0};
constexpr Rgb kCutPlaneMagenta{255, 60, 255};
constexpr double kPlaneGap_mm = 2.4;  // about each tick

Rgb chosen(const std::optional<Colour>& own, Rgb usual) {
    if (!own) return usual;
    Rgb rgb{};
    for (std::size_t i = 0; i < 3; ++i)
        rgb[i] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(static_cast<double>((*own)[i]), 0.0, 1.0)));
    return rgb;
}

/// A number of mm as on a label: one decimal at most.
std::string mm(double value) {
    const double rounded = std::round(10 * value) / 10;
    return rounded == std::round(rounded) ? fmt::format("{:.0f}", rounded) : fmt::format("{:.1f}", rounded);
}

}  // namespace

void PlanDrawer::draw(const OsteotomyLine& line) {
    std::vector<Point> on_ct_skin, on_skin;
    double far_mm = 0;
    if (finite(line))
        for (const Vector3d& p : line.points_in_ct) {
            const Point planned = ct_skin_.nearest(p);
            far_mm = std::max(far_mm, (planned.p_in_ct - p).norm());
            on_ct_skin.push_back(planned);
            on_skin.push_back(skin_.same_place(ct_skin_, planned));
        }
    const int i =
        begin(StrokeKind::osteotomy_line, line.name, on_skin.empty() ? Vector3d::Zero() : on_skin.front().p_in_ct,
              far_mm, faults(line, ct_skin_, settings_));
    if (on_skin.size() < 2 || too_far(item(i)) || no_place_of(line, ct_skin_)) return;
    const SkinLine way = join(skin_, on_skin, line.closed, settings_.max_segment_mm);
    if (way.points.size() < 2) return;
    item(i).label = line.name.empty() ? "Osteotomy" : line.name;
    const Rgb colour = chosen(line.colour, kOsteotomyGreen);
    add(StrokeKind::osteotomy_line, i, colour, settings_.line_width_mm, way);
    add_ticks(i, colour, way);
    allow_marks_at_ends(i, colour, way);
    // The plan's own length, as every page and window has it; the skin as it is now may make it a millimetre another.
    const double planned_mm = &ct_skin_ == &skin_
                                  ? length_mm(way)
                                  : length_mm(join(ct_skin_, on_ct_skin, line.closed, settings_.max_segment_mm));
    wish_along(i, fmt::format("{:.0f} mm", planned_mm), way);
}

void PlanDrawer::draw(const Borehole& hole) {
    if (!finite(hole)) {
        begin(StrokeKind::borehole, hole.name, Vector3d::Zero(), 0, faults(hole, ct_skin_, settings_));
        return;
    }
    const Point nearest = ct_skin_.nearest(hole.position_in_ct);
    const PlaceOnSkin place = place_of(hole, ct_skin_, skin_);
    const Point& at = place.at;
    const int i = begin(StrokeKind::borehole, hole.name, at.p_in_ct, (nearest.p_in_ct - hole.position_in_ct).norm(),
                        faults(hole, ct_skin_, settings_));
    if (too_far(item(i)) || !has_place(item(i), place, "its position", has_axis(hole))) return;
    const Rgb colour = chosen(hole.colour, kBoreholeCyan);
    const double radius_mm = std::max(hole.diameter_mm / 2, 0.0);
    std::vector<std::string> figures;
    if (radius_mm > 0) {
        add(StrokeKind::borehole, i, colour, settings_.line_width_mm,
            circle(skin_, at, radius_mm, settings_.max_segment_mm));
        figures.push_back(fmt::format("⌀{}", mm(hole.diameter_mm)));
    }
    if (hole.depth_mm > 0) figures.push_back(fmt::format("{} mm deep", mm(hole.depth_mm)));
    const TextFrame frame = text_frame(at, settings_.up_in_ct);
    // As long as the ring's own light can still be told from it by the cameras (`segments_of`).
    const double arm_mm =
        radius_mm > 0 ? std::max(std::min(1.5, 0.5 * radius_mm), std::min(5.0, radius_mm - 2.5)) : 1.5;
    add_bar(StrokeKind::borehole, i, colour, at, frame.right_in_ct, arm_mm, arm_mm);
    add_bar(StrokeKind::borehole, i, colour, at, frame.up_in_ct, arm_mm, arm_mm);
    const double clear_mm = std::max(radius_mm, arm_mm) + 2;
    allow_marks(i, colour, at, clear_mm, clear_mm);
    wish(i, std::move(figures), {at}, std::max(radius_mm, arm_mm));
}

void PlanDrawer::draw(const Trajectory& t) {
    if (!finite(t)) {
        begin(StrokeKind::trajectory, t.name, Vector3d::Zero(), 0, faults(t, ct_skin_, settings_));
        return;
    }
    const Point nearest = ct_skin_.nearest(t.entry_in_ct);
    const bool has_way = t.length_mm() > 1e-6;
    const Vector3d inwards =
        has_way ? Vector3d((t.target_in_ct - t.entry_in_ct) / t.length_mm()) : Vector3d(-nearest.normal_in_ct);
    const PlaceOnSkin place = place_of(t, ct_skin_, skin_);
    const Point& at = place.at;
    const int i = begin(StrokeKind::trajectory, t.name, at.p_in_ct, (nearest.p_in_ct - t.entry_in_ct).norm(),
                        faults(t, ct_skin_, settings_));
    if (too_far(item(i)) || !has_place(item(i), place, "its entry", true)) return;
    std::vector<std::string> figures;
    if (t.diameter_mm > 0) figures.push_back(fmt::format("⌀{}", mm(t.diameter_mm)));
    figures.push_back(fmt::format("{} mm", mm(t.length_mm())));
    const Rgb colour = chosen(t.colour, kTrajectoryAmber);
    const double radius_mm = ring_radius_mm(t), arm_mm = radius_mm + 2.5;
    add(StrokeKind::trajectory, i, colour, settings_.line_width_mm,
        circle(skin_, at, radius_mm, settings_.max_segment_mm));
    const TextFrame frame = text_frame(at, settings_.up_in_ct);
    add_bar(StrokeKind::trajectory, i, colour, at, frame.right_in_ct, arm_mm, arm_mm);
    add_bar(StrokeKind::trajectory, i, colour, at, frame.up_in_ct, arm_mm, arm_mm);
    allow_marks(i, colour, at, arm_mm + 2, radius_mm + 2);
    // The shadow of the way inside, cast straight out onto the skin: it shows which way to lean the instrument.
    const Vector3d shadow = inwards - inwards.dot(at.normal_in_ct) * at.normal_in_ct;
    const double shadow_mm = std::min(20.0, shadow.norm() * t.length_mm());
    if (shadow.norm() > 0.05 && shadow_mm > radius_mm + 1)
        add(StrokeKind::trajectory, i, colour, settings_.line_width_mm,
            bar(skin_, at, shadow, -radius_mm, shadow_mm, settings_.max_segment_mm));
    wish(i, std::move(figures), {at}, arm_mm);
}

void PlanDrawer::draw(const CutPlane& plane) {
    const auto warnings = faults(plane, ct_skin_, settings_);
    const std::vector<SkinLine> lines =
        is_plane(plane) ? trace(skin_, plane, settings_.max_segment_mm) : std::vector<SkinLine>();
    const int i = begin(StrokeKind::cut_plane, plane.name,
                        lines.empty() ? Vector3d::Zero() : lines.front().points.front().p_in_ct, 0, warnings);
    if (lines.empty()) return;
    item(i).label = plane.name.empty() ? "Cut" : plane.name;
    const Rgb colour = chosen(plane.colour, kCutPlaneMagenta);
    for (const SkinLine& line : lines) {
        add(StrokeKind::cut_plane, i, colour, settings_.line_width_mm, line);
        // In dashes from tick to tick: no osteotomy line to whoever sees no colours.
        drawing.strokes.back().gap_every_mm = settings_.tick_every_mm;
        drawing.strokes.back().gap_mm = kPlaneGap_mm;
        add_ticks(i, colour, line);
    }
    wish_along(i, fmt::format("{:.0f} mm", planned_length_mm(plane, lines.front())), lines.front());
}

/// The plan's own length of a plane's trace, as every page and window has it: of that line on the CT's skin which lies
/// nearest to the one drawn on the skin as it is now.
double PlanDrawer::planned_length_mm(const CutPlane& plane, const SkinLine& drawn) const {
    if (&ct_skin_ == &skin_) return length_mm(drawn);
    const auto apart_mm = [&](const SkinLine& line) {
        double sum_mm = 0;
        for (std::size_t i = 0; i < drawn.points.size(); i += 8) {
            double nearest_mm = std::numeric_limits<double>::infinity();
            for (const Point& p : line.points)
                nearest_mm = std::min(nearest_mm, (p.p_in_ct - drawn.points[i].p_in_ct).norm());
            sum_mm += nearest_mm;
        }
        return sum_mm;
    };
    const std::vector<SkinLine> planned = trace(ct_skin_, plane, settings_.max_segment_mm);
    if (planned.empty()) return length_mm(drawn);
    if (planned.size() == 1) return length_mm(planned.front());
    std::vector<double> apart;
    for (const SkinLine& line : planned) apart.push_back(apart_mm(line));
    const auto nearest = std::min_element(apart.begin(), apart.end()) - apart.begin();
    return length_mm(planned[static_cast<std::size_t>(nearest)]);
}

PlanDrawing draw_plan(const Plan& plan, const SkinSurface& skin, const DrawingSettings& settings) {
    return draw_plan(plan, skin, skin, settings);
}

PlanDrawing draw_plan(const Plan& plan, const SkinSurface& ct_skin, const SkinSurface& skin_now,
                      const DrawingSettings& settings, std::optional<std::vector<Clearances>> known) {
    PlanDrawer drawer(ct_skin, skin_now, settings, known ? std::move(*known) : clearances_of(plan, &ct_skin));
    drawer.name_items(plan);
    for (const auto& line : plan.osteotomy_lines) drawer.draw(line);
    for (const auto& hole : plan.boreholes) drawer.draw(hole);
    for (const auto& trajectory : plan.trajectories) drawer.draw(trajectory);
    for (const auto& plane : plan.cut_planes) drawer.draw(plane);
    drawer.draw_labels_and_marks();
    return std::move(drawer.drawing);
}

std::vector<Clearances> clearances_in(const PlanDrawing& drawing) {
    std::vector<Clearances> all;
    for (const DrawnItem& item : drawing.items) all.push_back(item.clearances);
    return all;
}

}  // namespace planlight
