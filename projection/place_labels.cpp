#include "projection/place_labels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "projection/stroke_places.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Point = SkinSurface::Point;

constexpr double kClear_mm = 2.6;            // between a text's outline and anything drawn
constexpr double kApartFromLabels_mm = 4.8;  // more than between a text's own lines: two labels are not one
constexpr double kLeaderClear_mm = 1;        // between a leader and anything drawn
constexpr double kLeaderFrom_mm = 3;         // a text farther from its item has a leader
constexpr double kOffItem_mm = 0.8;          // a text is so much farther from what is drawn at the anchor
constexpr double kLeaderOff_mm = 2;          // between that and the leader: CHECK can still tell the item's light

struct Candidate {
    TextFrame frame;
    double cost = 1e300, gap_mm = 0;
    std::vector<Point> leader;
};

/// The skin point at (x, y) mm of the text's own plane, by a straight way.
std::optional<Point> on_skin(const SkinSurface& skin, const TextFrame& f, const Vector2d& xy) {
    return skin.walk(f.at, xy.x() * f.right_in_ct + xy.y() * f.up_in_ct);
}

/// Looks for the best place of one label.
class Search {
public:
    Search(const LabelWish& wish, const SkinSurface& skin, const DrawingSettings& settings,
           const OccupiedSkin& occupied, const TextBlock& block)
        : wish_(wish), skin_(skin), settings_(settings), occupied_(occupied), block_(block) {}

    std::optional<Candidate> best() {
        for (const double gap_mm : wish_.gaps_mm) {
            for (std::size_t a = 0; a < wish_.anchors.size(); ++a) try_round(a, gap_mm);
            if (best_) return best_;
        }
        return std::nullopt;
    }

private:
    void try_round(std::size_t anchor, double gap_mm);
    double cost_of(std::size_t anchor, double angle, double gap_mm, const Point& middle) const;
    bool lit(const Point& p) const;
    bool is_free(const TextFrame& frame) const;
    bool is_close_to_another(const TextFrame& frame) const;
    std::optional<std::vector<Point>> leader(const Point& anchor, const TextFrame& frame) const;
    /// How far the middle of the text must be from a point so that its outline is clear of it in direction `angle`.
    double reach_mm(double angle) const {
        const double c = std::abs(std::cos(angle)), s = std::abs(std::sin(angle));
        return std::min(c > 1e-9 ? block_.width_mm / 2 / c : 1e9, s > 1e-9 ? block_.height_mm / 2 / s : 1e9);
    }

    const LabelWish& wish_;
    const SkinSurface& skin_;
    const DrawingSettings& settings_;
    const OccupiedSkin& occupied_;
    const TextBlock& block_;
    std::optional<Candidate> best_;
};

bool Search::lit(const Point& p) const {
    if (!settings_.light) return true;
    const LightView& light = *settings_.light;
    const auto pixel = project(light.projector, light.rig_from_ct * p.p_in_ct);
    if (!pixel || pixel->x() < light.margin_px || pixel->y() < light.margin_px ||
        pixel->x() > light.projector.width - 1 - light.margin_px ||
        pixel->y() > light.projector.height - 1 - light.margin_px)
        return false;
    StrokePlace place;
    place.p_in_ct = p.p_in_ct;
    place.normal_in_ct = p.normal_in_ct;
    return freely_seen(place, skin_, light.projector, light.rig_from_ct, light.steepest);
}

bool Search::is_close_to_another(const TextFrame& frame) const {
    constexpr double kClose_mm = 4.5;
    const Vector2d half(block_.width_mm / 2, block_.height_mm / 2);
    for (const LabelWish::Other& other : wish_.others) {
        const Vector3d way = other.p_in_ct - frame.at.p_in_ct;
        const Vector2d xy(way.dot(frame.right_in_ct), way.dot(frame.up_in_ct));
        const double off_skin_mm = way.dot(frame.at.normal_in_ct);
        const double from_text_mm = (xy.cwiseAbs() - half).cwiseMax(0).norm();
        if (std::hypot(from_text_mm, std::min(0.0, off_skin_mm + 20)) < other.half_size_mm + kClose_mm) return true;
    }
    return false;
}

/// True when all of the text's outline lies on skin that is free, flat and lit.
bool Search::is_free(const TextFrame& frame) const {
    constexpr double kApart_mm = 2.2, kFlat = 0.85;
    if (is_close_to_another(frame)) return false;
    const int nx = std::max(1, static_cast<int>(std::ceil(block_.width_mm / kApart_mm)));
    const int ny = std::max(1, static_cast<int>(std::ceil(block_.height_mm / kApart_mm)));
    for (int ix = 0; ix <= nx; ++ix)
        for (int iy = 0; iy <= ny; ++iy) {
            const Vector2d xy(block_.width_mm * (static_cast<double>(ix) / nx - 0.5),
                              block_.height_mm * (static_cast<double>(iy) / ny - 0.5));
            const auto p = on_skin(skin_, frame, xy);
            if (!p || !skin_.real_skin(*p) || p->normal_in_ct.dot(frame.at.normal_in_ct) < kFlat) return false;
            if (occupied_.within(p->p_in_ct, kClear_mm, wish_.but_of, kApartFromLabels_mm) || !lit(*p)) return false;
        }
    return true;
}

double Search::cost_of(std::size_t anchor, double angle, double gap_mm, const Point& middle) const {
    const Point& from = wish_.anchors[anchor];
    Vector3d facing = wish_.facing_in_ct.value_or(from.normal_in_ct);
    if (settings_.light)
        facing = (settings_.light->rig_from_ct.inverse() * settings_.light->projector.centre_in_rig() - middle.p_in_ct)
                     .normalized();
    double cost = gap_mm + 0.3 * static_cast<double>(anchor) + 2 * std::abs(std::sin(angle)) +
                  (std::cos(angle) < -0.1 ? 0.5 : 0) + 30 * (1 - middle.normal_in_ct.dot(facing));
    if (wish_.away_from_in_ct &&
        (middle.p_in_ct - *wish_.away_from_in_ct).norm() < (from.p_in_ct - *wish_.away_from_in_ct).norm())
        cost += 15;
    return cost;
}

/// The places at `gap_mm` beyond what is drawn at the anchor.
void Search::try_round(std::size_t anchor, double gap_mm) {
    constexpr int kDirections = 16;
    const TextFrame at_anchor = text_frame(wish_.anchors[anchor], settings_.up_in_ct);
    for (int d = 0; d < kDirections; ++d) {
        const double angle = 2 * std::numbers::pi * d / kDirections;
        const double way_mm = wish_.keep_off_mm + kClear_mm + kOffItem_mm + gap_mm + reach_mm(angle);
        const auto middle = on_skin(skin_, at_anchor, way_mm * Vector2d(std::cos(angle), std::sin(angle)));
        if (!middle) continue;
        const double cost = cost_of(anchor, angle, gap_mm, *middle);
        if (best_ && cost >= best_->cost) continue;
        const TextFrame frame = text_frame(*middle, settings_.up_in_ct);
        if (!is_free(frame)) continue;
        std::vector<Point> way;
        if (wish_.leader && gap_mm >= kLeaderFrom_mm) {
            auto found = leader(wish_.anchors[anchor], frame);
            if (!found) continue;
            way = std::move(*found);
        }
        best_ = Candidate{frame, cost, gap_mm, std::move(way)};
    }
}

/// A straight way from what is named to the text; empty when it would cross anything or lie in no light.
std::optional<std::vector<Point>> Search::leader(const Point& anchor, const TextFrame& frame) const {
    constexpr double kBefore_mm = 1.2;
    const SkinLine line = straight_way(skin_, anchor, frame.at, settings_.max_segment_mm);
    std::vector<Point> points;
    for (const Point& p : line.points) {
        const Vector3d from_text = p.p_in_ct - frame.at.p_in_ct;
        const bool in_text = std::abs(from_text.dot(frame.right_in_ct)) < block_.width_mm / 2 + kBefore_mm &&
                             std::abs(from_text.dot(frame.up_in_ct)) < block_.height_mm / 2 + kBefore_mm;
        if (in_text) break;
        if ((p.p_in_ct - anchor.p_in_ct).norm() < wish_.keep_off_mm + kLeaderOff_mm) continue;
        const double own_mm = (p.p_in_ct - anchor.p_in_ct).norm() - wish_.keep_off_mm;
        const double clear_mm = std::min(kLeaderClear_mm, 0.7 * own_mm);  // its own item is near where it begins
        if (occupied_.within(p.p_in_ct, clear_mm, wish_.but_of) || !lit(p)) return std::nullopt;
        points.push_back(p);
    }
    return points;
}

}  // namespace

std::int64_t OccupiedSkin::key(const Eigen::Vector3i& cell) {
    return (static_cast<std::int64_t>(cell.x()) * 2097169 + cell.y()) * 2097169 + cell.z();
}

void OccupiedSkin::add(const Vector3d& p_in_ct, int owner) {
    auto& cell = cells_[key((p_in_ct / kCell_mm).array().floor().cast<int>())];
    // Where a crowded plan is drawn over itself a cell would grow without end, and each look into it with it.
    constexpr double kSame_mm = 0.2;
    for (const Taken& q : cell)
        if (q.owner == owner && (q.p_in_ct - p_in_ct).squaredNorm() < kSame_mm * kSame_mm) return;
    cell.push_back({p_in_ct, owner});
}

void OccupiedSkin::take_away(const Vector3d& p_in_ct, int owner) {
    const auto cell = cells_.find(key((p_in_ct / kCell_mm).array().floor().cast<int>()));
    if (cell != cells_.end()) std::erase_if(cell->second, [&](const Taken& q) { return q.owner == owner; });
}

bool OccupiedSkin::within(const Vector3d& p_in_ct, double distance_mm, int but_of, double labels_mm) const {
    const Eigen::Vector3i cell = (p_in_ct / kCell_mm).array().floor().cast<int>();
    for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
            for (int dz = -1; dz <= 1; ++dz) {
                const auto found = cells_.find(key(cell + Eigen::Vector3i(dx, dy, dz)));
                if (found == cells_.end()) continue;
                for (const Taken& q : found->second) {
                    if (q.owner != kPlan && (but_of == kAllLabels || but_of == q.owner)) continue;
                    const double clear_mm = q.owner == kPlan ? distance_mm : std::max(distance_mm, labels_mm);
                    if ((q.p_in_ct - p_in_ct).squaredNorm() < clear_mm * clear_mm) return true;
                }
            }
    return false;
}

void occupy_kept_clear(const SkinSurface& skin, const DrawingSettings& settings, OccupiedSkin& occupied) {
    for (const Vector3d& marker : settings.keep_clear_in_ct) {
        const SkinSurface::Point centre = skin.nearest(marker);
        for (double r = 1; r <= settings.keep_clear_radius_mm; r += 1)
            for (const SkinSurface::Point& p : circle(skin, centre, r, 1).points) occupied.add(p.p_in_ct);
    }
}

namespace {

template <class Visit>
void each_point(const Label& label, const Visit& visit) {
    for (const Vector3d& p : label.field_in_ct) visit(p);
    for (const auto& sign : label.signs_in_ct)
        for (const auto& outline : sign)
            for (const Vector3d& p : outline) visit(p);
    for (const Vector3d& p : label.leader.points_in_ct) visit(p);
}

}  // namespace

void occupy(const Label& label, OccupiedSkin& occupied) {
    each_point(label, [&](const Vector3d& p) { occupied.add(p, label.item); });
}

void vacate(const Label& label, OccupiedSkin& occupied) {
    each_point(label, [&](const Vector3d& p) { occupied.take_away(p, label.item); });
}

std::optional<Label> place_label(const LabelWish& wish, const SkinSurface& skin, const DrawingSettings& settings,
                                 const OccupiedSkin& occupied) {
    const double height_mm = wish.text_height_mm > 0 ? wish.text_height_mm : settings.text_height_mm;
    const TextBlock block = lay_out(wish.text, height_mm);
    if (block.lines.empty()) return std::nullopt;
    const auto found = Search(wish, skin, settings, occupied, block).best();
    if (!found) return std::nullopt;
    auto label = draw_label(skin, found->frame, block, wish.item, height_mm);
    if (!label) return std::nullopt;
    label->gap_mm = found->gap_mm;
    constexpr std::size_t kLongEnoughToBeSeen = 5;  // points, half a millimetre apart
    if (found->leader.size() >= kLongEnoughToBeSeen)
        for (const Point& p : found->leader) {
            label->leader.points_in_ct.push_back(p.p_in_ct);
            label->leader.normals_in_ct.push_back(p.normal_in_ct);
        }
    return label;
}

}  // namespace planlight
