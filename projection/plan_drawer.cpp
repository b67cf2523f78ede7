#include "projection/plan_drawer.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "projection/check_items.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using Point = SkinSurface::Point;

constexpr double kToldRisk_mm = 10;  // what is farther away makes labels longer and warns nobody

}  // namespace

int PlanDrawer::begin(StrokeKind kind, const std::string& name, const Vector3d& anchor, double distance_mm,
                      std::vector<std::string> warnings) {
    const LitName& lit = names_[drawing.items.size()];
    if (!lit.warning.empty()) warnings.push_back(lit.warning);
    drawing.items.push_back(
        {kind, name, name, anchor, distance_mm, std::move(warnings), true, lit.name, lit.code, lit.by_code, {}, {}});
    if (const std::size_t i = drawing.items.size() - 1; i < clearances_.size())
        drawing.items.back().clearances = clearances_[i];
    return static_cast<int>(drawing.items.size()) - 1;
}

bool PlanDrawer::too_far(const DrawnItem& item) const {
    return item.distance_to_skin_mm > kTooFarFactor * settings_.max_distance_to_skin_mm;
}

/// Whether something can be drawn there. What is said of the CT's skin has been said; of the skin as it is now it is
/// said here.
bool PlanDrawer::has_place(DrawnItem& item, const PlaceOnSkin& now, const char* what, bool axis) const {
    const auto why = no_place(skin_, now, what, axis);
    if (&ct_skin_ == &skin_) return !why;
    const std::string begin = fmt::format("{}: as the skin lies now, ", item.name);
    if (why)
        item.warnings.push_back(begin + *why + "; it is not drawn");
    else if (axis && now.aside_mm > kToldAside_mm)
        item.warnings.push_back(
            begin +
            fmt::format("its axis does not meet the skin within {:.0f} mm of {}; it is drawn {:.1f} mm beside the axis",
                        kMostAlong_mm, what, now.aside_mm));
    return !why;
}

void PlanDrawer::add(StrokeKind kind, int item_index, Rgb colour, double width_mm, const SkinLine& line) {
    if (line.points.size() < 2) return;
    Stroke stroke{kind, item_index, colour, width_mm, line.closed, {}, {}};
    for (const Point& p : line.points) {
        stroke.points_in_ct.push_back(p.p_in_ct);
        stroke.normals_in_ct.push_back(p.normal_in_ct);
    }
    drawing.strokes.push_back(std::move(stroke));
}

void PlanDrawer::add_bar(StrokeKind kind, int item_index, Rgb colour, const Point& at, const Vector3d& direction,
                         double back_mm, double ahead_mm) {
    add(kind, item_index, colour, 0.7 * settings_.line_width_mm,
        bar(skin_, at, direction, back_mm, ahead_mm, settings_.max_segment_mm));
}

/// A tick every 10 mm along the line from its first point, every fifth twice as long.
void PlanDrawer::add_ticks(int item_index, Rgb colour, const SkinLine& line) {
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

/// Marks about a point: on its cross's arms, from so far on, and between them.
void PlanDrawer::allow_marks(int item_index, Rgb colour, const Point& at, double crossed_from_mm,
                             double between_from_mm) {
    const TextFrame frame = text_frame(at, settings_.up_in_ct);
    const Vector3d &right = frame.right_in_ct, &up = frame.up_in_ct;
    MarkPlace place{item_index, colour, at, {}};
    for (const Vector3d& way : {right, up, Vector3d(-right), Vector3d(-up)})
        place.rays.push_back({way, crossed_from_mm});
    for (const Vector3d& way :
         {Vector3d(right + up), Vector3d(up - right), Vector3d(-right - up), Vector3d(right - up)})
        place.rays.push_back({way.normalized(), between_from_mm});
    if (between_from_mm < crossed_from_mm) std::rotate(place.rays.begin(), place.rays.begin() + 4, place.rays.end());
    marks_.push_back(std::move(place));
}

/// To both sides of a line's ends, clear of the ticks there.
void PlanDrawer::allow_marks_at_ends(int item_index, Rgb colour, const SkinLine& line) {
    if (line.closed) return;
    const double from_mm = settings_.tick_length_mm + 2, whole_mm = length_mm(line);
    for (const double way_mm : {0.0, whole_mm}) {
        const LinePlace end = place_along(skin_, line, way_mm);
        const Vector3d aside = end.at.normal_in_ct.cross(end.direction_in_ct);
        marks_.push_back({item_index, colour, end.at, {{aside, from_mm}, {-aside, from_mm}}, 2});
    }
}

/// A label beside one of the anchors: the item's name, and figures with their units.
void PlanDrawer::wish(int item_index, std::vector<std::string> figures, std::vector<Point> anchors, double keep_off_mm,
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
std::optional<RiskText> PlanDrawer::risk_of(const DrawnItem& named) const {
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

void PlanDrawer::wish_along(int item_index, const std::string& figure, const SkinLine& line) {
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

void PlanDrawer::draw_labels_and_marks() {
    const PlanDrawing bare = drawing;
    const auto complete = [&] {
        if (settings_.labels) place_all_labels(wishes_, skin_, settings_, drawing);
        if (settings_.check_marks) add_check_marks(marks_, skin_, settings_, drawing);
    };
    const auto untold = [](const PlanDrawing& drawn) {
        const std::vector<bool> items = untold_items(drawn);
        return std::count(items.begin(), items.end(), true);
    };
    complete();
    if (!settings_.labels || !settings_.check_marks || untold(drawing) == 0) return;
    const PlanDrawing labels_first = std::exchange(drawing, bare);
    const std::vector<bool> missing = untold_items(labels_first);
    std::vector<MarkPlace> first;
    for (const MarkPlace& place : marks_)
        if (missing[static_cast<std::size_t>(place.item)]) first.push_back(place);
    add_check_marks(first, skin_, settings_, drawing);
    complete();
    const bool all_labels = drawing.labels.size() >= labels_first.labels.size() &&
                            drawing.card.has_value() >= labels_first.card.has_value();
    if (!all_labels || untold(drawing) >= untold(labels_first)) drawing = labels_first;
}

void PlanDrawer::name_items(const Plan& plan) {
    names_ = lit_names(names_of(plan), settings_.text_height_mm);
    const auto lit = lit_structures(plan, settings_.text_height_mm);
    for (std::size_t i = 0; i < lit.size(); ++i) structures_[plan.risk_structures[i].name] = lit[i].name;
}

}  // namespace planlight
