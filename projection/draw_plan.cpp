#include "projection/draw_plan.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "projection/check_items.h"
#include "projection/label_names.h"
#include "projection/place_all_labels.h"
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
constexpr double kSymbolRadius_mm =
    3;  // of a trajectory's ring when the instrument's diameter is not given, or is smaller
constexpr double kToldRisk_mm = 10;  // what is farther away makes labels longer and warns nobody

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

/// A plan item's place on the skin: where its axis passes through near the point, else the nearest point.
Point on_skin_along(const SkinSurface& skin, const Vector3d& p, const Vector3d& axis) {
    const Point nearest = skin.nearest(p);
    const double distance_mm = (nearest.p_in_ct - p).norm();
    std::optional<Point> best;
    for (const double sign : {1.0, -1.0}) {
        const auto hit = skin.first_hit({p, sign * axis});
        if (!hit || (hit->p_in_ct - p).norm() > 2 * distance_mm + 0.5) continue;
        if (!best || (hit->p_in_ct - p).norm() < (best->p_in_ct - p).norm()) best = hit;
    }
    return best ? *best : nearest;
}

class Drawer {
public:
    Drawer(const SkinSurface& ct_skin, const SkinSurface& skin_now, const DrawingSettings& settings,
           std::vector<Clearances> clearances)
        : ct_skin_(ct_skin), skin_(skin_now), settings_(settings), clearances_(std::move(clearances)) {}

    void draw(const OsteotomyLine& line);
    void draw(const Borehole& hole);
    void draw(const Trajectory& trajectory);
    void draw(const CutPlane& plane);
    void name_items(const Plan& plan);
    void draw_labels() { place_all_labels(std::move(wishes_), skin_, settings_, drawing); }
    PlanDrawing drawing;

private:
    int begin(StrokeKind kind, const std::string& name, const Vector3d& anchor, double distance_mm,
              std::vector<std::string> warnings);
    bool too_far(const DrawnItem& item) const {
        return item.distance_to_skin_mm > kTooFarFactor * settings_.max_distance_to_skin_mm;
    }
    DrawnItem& item(int i) { return drawing.items[static_cast<std::size_t>(i)]; }
    void add(StrokeKind kind, int item_index, Rgb colour, double width_mm, const SkinLine& line);
    void add_bar(StrokeKind kind, int item_index, Rgb colour, const Point& at, const Vector3d& direction,
                 double back_mm, double ahead_mm);
    void add_ticks(int item_index, Rgb colour, const SkinLine& line);
    void wish(int item_index, std::vector<std::string> figures, std::vector<Point> anchors, double keep_off_mm,
              std::optional<Vector3d> away_from = {});
    std::optional<RiskText> risk_of(const DrawnItem& named) const;
    void wish_along(int item_index, const std::string& figure, const SkinLine& line);
    double planned_length_mm(const CutPlane& plane, const SkinLine& drawn) const;

    const SkinSurface& ct_skin_;  ///< on which was planned
    const SkinSurface& skin_;     ///< as it is now: what is drawn on
    const DrawingSettings& settings_;
    std::vector<Clearances> clearances_;  ///< in the order of the items, as all of these
    std::vector<LitName> names_;
    std::map<std::string, std::string> structures_;  ///< the plan's name of a risk structure, and the light's
    std::vector<LabelWish> wishes_;
};

int Drawer::begin(StrokeKind kind, const std::string& name, const Vector3d& anchor, double distance_mm,
                  std::vector<std::string> warnings) {
    const LitName& lit = names_[drawing.items.size()];
    if (!lit.warning.empty()) warnings.push_back(lit.warning);
    drawing.items.push_back(
        {kind, name, name, anchor, distance_mm, std::move(warnings), true, lit.name, lit.code, lit.by_code, {}, {}});
    if (const std::size_t i = drawing.items.size() - 1; i < clearances_.size())
        drawing.items.back().clearances = clearances_[i];
    return static_cast<int>(drawing.items.size()) - 1;
}

void Drawer::add(StrokeKind kind, int item_index, Rgb colour, double width_mm, const SkinLine& line) {
    if (line.points.size() < 2) return;
    Stroke stroke{kind, item_index, colour, width_mm, line.closed, {}, {}};
    for (const Point& p : line.points) {
        stroke.points_in_ct.push_back(p.p_in_ct);
        stroke.normals_in_ct.push_back(p.normal_in_ct);
    }
    drawing.strokes.push_back(std::move(stroke));
}

void Drawer::add_bar(StrokeKind kind, int item_index, Rgb colour, const Point& at, const Vector3d& direction,
                     double back_mm, double ahead_mm) {
    add(kind, item_index, colour, 0.7 * settings_.line_width_mm,
        bar(skin_, at, direction, back_mm, ahead_mm, settings_.max_segment_mm));
}

/// A tick every 10 mm along the line from its first point, every fifth twice as long.
void Drawer::add_ticks(int item_index, Rgb colour, const SkinLine& line) {
    if (!(settings_.tick_every_mm > 0) || line.points.size() < 2) return;
    const double whole_mm = length_mm(line);
    const double last_mm = line.closed ? whole_mm - settings_.tick_length_mm : whole_mm + 1e-6;
    for (int k = 0; k * settings_.tick_every_mm <= last_mm; ++k) {
        const LinePlace place = place_along(skin_, line, k * settings_.tick_every_mm);
        const double half_mm = settings_.tick_length_mm / 2 * (k % 5 == 0 ? 2 : 1);
        add_bar(StrokeKind::tick, item_index, colour, place.at, place.at.normal_in_ct.cross(place.direction_in_ct),
                half_mm, half_mm);
    }
}

/// A label beside one of the anchors: the item's name, and figures with their units.
void Drawer::wish(int item_index, std::vector<std::string> figures, std::vector<Point> anchors, double keep_off_mm,
                  std::optional<Vector3d> away_from) {
    DrawnItem& named = item(item_index);
    for (std::string& figure : figures) {
        named.label += "  " + figure;
        // The sign is read as a digit by whoever reads quickly: 25 for ⌀5.
        static const std::string kDiameter = "⌀";
        if (figure.rfind(kDiameter, 0) == 0) figure = figure.substr(kDiameter.size()) + " mm wide";
    }
    // Figures alone would be read as those of an item without a name.
    const bool none = names_[static_cast<std::size_t>(item_index)].none;
    named.labelled = !none;
    if (none || (named.lit_name.empty() && figures.empty())) return;
    wishes_.push_back({item_index,
                       {named.lit_name, std::move(figures), risk_of(named)},
                       named.code,
                       std::move(anchors),
                       keep_off_mm,
                       away_from,
                       {}});
}

/// What the label says of the nearest risk structure: of ways in and holes where it is near, of what is cut where it
/// warns.
std::optional<RiskText> Drawer::risk_of(const DrawnItem& named) const {
    if (named.clearances.empty()) return std::nullopt;
    const Clearance& worst = named.clearances.front();
    const bool cut = named.kind == StrokeKind::osteotomy_line || named.kind == StrokeKind::cut_plane;
    if (!warns(worst) && (cut || said_mm(worst) > kToldRisk_mm)) return std::nullopt;
    RiskText risk{worst.through ? "through" : fmt::format("{:.1f} mm to", said_mm(worst)),
                  structures_.at(worst.structure),
                  {},
                  warns(worst),
                  worst.mm};
    if (const auto others = warnings_in(named.clearances); others > 1)
        risk.more = fmt::format("and {} more", others - 1);
    return risk;
}

void Drawer::wish_along(int item_index, const std::string& figure, const SkinLine& line) {
    constexpr int kAnchors = 12;
    std::vector<Point> anchors;
    const double whole_mm = length_mm(line);
    for (int k = 0; k < kAnchors; ++k) anchors.push_back(place_along(skin_, line, whole_mm * (k + 0.5) / kAnchors).at);
    std::sort(anchors.begin(), anchors.end(), [&](const Point& a, const Point& b) {
        return a.p_in_ct.dot(settings_.up_in_ct) > b.p_in_ct.dot(settings_.up_in_ct);
    });
    std::optional<Vector3d> middle;
    if (line.closed) {
        middle = Vector3d::Zero();
        for (const Point& p : line.points) *middle += p.p_in_ct / static_cast<double>(line.points.size());
    }
    wish(item_index, {figure}, std::move(anchors), settings_.tick_length_mm, middle);
}

void Drawer::draw(const OsteotomyLine& line) {
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
    if (on_skin.size() < 2 || too_far(item(i))) return;
    const SkinLine way = join(skin_, on_skin, line.closed, settings_.max_segment_mm);
    if (way.points.size() < 2) return;
    item(i).label = line.name.empty() ? "Osteotomy" : line.name;
    const Rgb colour = chosen(line.colour, kOsteotomyGreen);
    add(StrokeKind::osteotomy_line, i, colour, settings_.line_width_mm, way);
    add_ticks(i, colour, way);
    // The plan's own length, as every page and window has it; the skin as it is now may make it a millimetre another.
    const double planned_mm = &ct_skin_ == &skin_
                                  ? length_mm(way)
                                  : length_mm(join(ct_skin_, on_ct_skin, line.closed, settings_.max_segment_mm));
    wish_along(i, fmt::format("{:.0f} mm", planned_mm), way);
}

void Drawer::draw(const Borehole& hole) {
    if (!finite(hole)) {
        begin(StrokeKind::borehole, hole.name, Vector3d::Zero(), 0, faults(hole, ct_skin_, settings_));
        return;
    }
    const Point nearest = ct_skin_.nearest(hole.position_in_ct);
    const Point at = hole.axis_in_ct && hole.axis_in_ct->norm() > 0.5
                         ? on_skin_along(skin_, hole.position_in_ct, hole.axis_in_ct->normalized())
                         : skin_.same_place(ct_skin_, nearest);
    const int i = begin(StrokeKind::borehole, hole.name, at.p_in_ct, (nearest.p_in_ct - hole.position_in_ct).norm(),
                        faults(hole, ct_skin_, settings_));
    if (too_far(item(i))) return;
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
    wish(i, std::move(figures), {at}, std::max(radius_mm, arm_mm));
}

void Drawer::draw(const Trajectory& t) {
    if (!finite(t)) {
        begin(StrokeKind::trajectory, t.name, Vector3d::Zero(), 0, faults(t, ct_skin_, settings_));
        return;
    }
    const Point nearest = ct_skin_.nearest(t.entry_in_ct);
    const bool has_way = t.length_mm() > 1e-6;
    const Vector3d inwards =
        has_way ? Vector3d((t.target_in_ct - t.entry_in_ct) / t.length_mm()) : Vector3d(-nearest.normal_in_ct);
    const Point at = on_skin_along(skin_, t.entry_in_ct, inwards);
    const int i = begin(StrokeKind::trajectory, t.name, at.p_in_ct, (nearest.p_in_ct - t.entry_in_ct).norm(),
                        faults(t, ct_skin_, settings_));
    if (too_far(item(i))) return;
    std::vector<std::string> figures;
    if (t.diameter_mm > 0) figures.push_back(fmt::format("⌀{}", mm(t.diameter_mm)));
    figures.push_back(fmt::format("{} mm", mm(t.length_mm())));
    const Rgb colour = chosen(t.colour, kTrajectoryAmber);
    const double radius_mm = std::max(t.diameter_mm / 2, kSymbolRadius_mm), arm_mm = radius_mm + 2.5;
    add(StrokeKind::trajectory, i, colour, settings_.line_width_mm,
        circle(skin_, at, radius_mm, settings_.max_segment_mm));
    const TextFrame frame = text_frame(at, settings_.up_in_ct);
    add_bar(StrokeKind::trajectory, i, colour, at, frame.right_in_ct, arm_mm, arm_mm);
    add_bar(StrokeKind::trajectory, i, colour, at, frame.up_in_ct, arm_mm, arm_mm);
    // The shadow of the way inside, cast straight out onto the skin: it shows which way to lean the instrument.
    const Vector3d shadow = inwards - inwards.dot(at.normal_in_ct) * at.normal_in_ct;
    const double shadow_mm = std::min(20.0, shadow.norm() * t.length_mm());
    if (shadow.norm() > 0.05 && shadow_mm > radius_mm + 1)
        add(StrokeKind::trajectory, i, colour, settings_.line_width_mm,
            bar(skin_, at, shadow, -radius_mm, shadow_mm, settings_.max_segment_mm));
    wish(i, std::move(figures), {at}, arm_mm);
}

void Drawer::draw(const CutPlane& plane) {
    const auto warnings = faults(plane, ct_skin_, settings_);
    const bool drawable = finite(plane) && std::abs(plane.normal_in_ct.norm() - 1) < 1e-3 &&
                          std::abs(plane.first_axis_in_ct.norm() - 1) < 1e-3 &&
                          std::abs(plane.normal_in_ct.dot(plane.first_axis_in_ct)) < 1e-3;
    const std::vector<SkinLine> lines =
        drawable ? trace(skin_, plane, settings_.max_segment_mm) : std::vector<SkinLine>();
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
double Drawer::planned_length_mm(const CutPlane& plane, const SkinLine& drawn) const {
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

/// What the light calls each item; warned of where it is not the plan's name.
void Drawer::name_items(const Plan& plan) {
    names_ = lit_names(names_of(plan), settings_.text_height_mm);
    const auto lit = lit_structures(plan, settings_.text_height_mm);
    for (std::size_t i = 0; i < lit.size(); ++i) structures_[plan.risk_structures[i].name] = lit[i].name;
}

}  // namespace

PlanDrawing draw_plan(const Plan& plan, const SkinSurface& skin, const DrawingSettings& settings) {
    return draw_plan(plan, skin, skin, settings);
}

PlanDrawing draw_plan(const Plan& plan, const SkinSurface& ct_skin, const SkinSurface& skin_now,
                      const DrawingSettings& settings, std::optional<std::vector<Clearances>> known) {
    Drawer drawer(ct_skin, skin_now, settings, known ? std::move(*known) : clearances_of(plan, &ct_skin));
    drawer.name_items(plan);
    for (const auto& line : plan.osteotomy_lines) drawer.draw(line);
    for (const auto& hole : plan.boreholes) drawer.draw(hole);
    for (const auto& trajectory : plan.trajectories) drawer.draw(trajectory);
    for (const auto& plane : plan.cut_planes) drawer.draw(plane);
    if (settings.labels) drawer.draw_labels();
    return std::move(drawer.drawing);
}

std::vector<Clearances> clearances_in(const PlanDrawing& drawing) {
    std::vector<Clearances> all;
    for (const DrawnItem& item : drawing.items) all.push_back(item.clearances);
    return all;
}

}  // namespace planlight
