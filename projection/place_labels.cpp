#include "projection/place_labels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "projection/stroke_font.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Point = SkinSurface::Point;

constexpr double kLineSpacing = 1.65;  // of the text height
constexpr double kMaxWidth_mm = 44;  // of a text line: its ends are 22 mm from its middle, where the map is still true
constexpr Rgb kWhite{235, 235, 235};
constexpr double kClear_mm = 2.6;  // between a text's outline and anything drawn

struct Candidate {
    TextFrame frame;
    double cost = 1e300;
    int overlaps = 1 << 20;
    double gap_mm = 0;
    Point anchor;
};

/// The skin point at (x, y) mm of the text's own plane, by a straight way.
std::optional<Point> on_skin(const SkinSurface& skin, const TextFrame& f, const Vector2d& xy) {
    return skin.walk(f.at, xy.x() * f.right_in_ct + xy.y() * f.up_in_ct);
}

/// How many places of the text's outline are taken, bent away, or no skin.
int count_overlaps(const SkinSurface& skin, const TextFrame& f, const TextBlock& block, const OccupiedSkin& occupied,
                   int give_up) {
    int bad = 0;
    const int nx = std::max(1, static_cast<int>(std::ceil(block.width_mm / 2.2)));
    const int ny = std::max(1, static_cast<int>(std::ceil(block.height_mm / 2.2)));
    for (int ix = 0; ix <= nx; ++ix)
        for (int iy = 0; iy <= ny && bad < give_up; ++iy) {
            const Vector2d xy(block.width_mm * (static_cast<double>(ix) / nx - 0.5),
                              block.height_mm * (static_cast<double>(iy) / ny - 0.5));
            const auto p = on_skin(skin, f, xy);
            const bool good = p && skin.real_skin(*p) && p->normal_in_ct.dot(f.at.normal_in_ct) > 0.7 &&
                              !occupied.within(p->p_in_ct, kClear_mm);
            bad += good ? 0 : 1;
        }
    return bad;
}

/// Lines that would be too wide are broken at blanks, and inside a word only when it alone is too wide.
void add_wrapped(const std::u32string& part, double text_height_mm, std::vector<std::u32string>& lines) {
    std::u32string rest = part;
    while (!rest.empty()) {
        std::size_t fits = 1;
        while (fits < rest.size() && text_width(rest.substr(0, fits + 1)) * text_height_mm <= kMaxWidth_mm) ++fits;
        if (fits < rest.size()) {
            const auto blank = rest.rfind(U' ', fits);
            if (blank != std::u32string::npos && blank > 0) fits = blank;
        }
        lines.push_back(rest.substr(0, fits));
        rest = rest.substr(fits);
        while (!rest.empty() && rest.front() == U' ') rest.erase(rest.begin());
    }
}

void add_stroke(const std::vector<Point>& points, int item, double width_mm, std::vector<Stroke>& strokes) {
    if (points.size() < 2) return;
    Stroke stroke{StrokeKind::label, item, kWhite, width_mm, false, {}, {}};
    for (const Point& p : points) {
        stroke.points_in_ct.push_back(p.p_in_ct);
        stroke.normals_in_ct.push_back(p.normal_in_ct);
    }
    strokes.push_back(std::move(stroke));
}

/// One sign on its own little map round its middle, `middle_xy` mm from the text's.
void draw_glyph(const SkinSurface& skin, const TextFrame& text, const Glyph& g, const Vector2d& middle_xy,
                const DrawingSettings& settings, int item, std::vector<Stroke>& strokes) {
    const Vector3d way_there = middle_xy.x() * text.right_in_ct + middle_xy.y() * text.up_in_ct;
    const auto way = skin.walk_way(text.at, way_there, 1e9);
    if (!way) return;
    TextFrame f{way->points.back(), text.right_in_ct, text.up_in_ct};
    if (middle_xy.norm() > 1e-9) {  // the frame carried along the way: its angle to the way stays the same
        const Vector3d ahead = way->direction_at_end_in_ct, aside = f.at.normal_in_ct.cross(ahead);
        const Vector2d along = middle_xy.normalized();
        f.right_in_ct = along.x() * ahead - along.y() * aside;
        f.up_in_ct = along.y() * ahead + along.x() * aside;
    }
    const double h = settings.text_height_mm;
    for (const auto& line : g.lines) {
        std::vector<Point> points;
        for (std::size_t i = 0; i + 1 < line.size(); ++i) {
            const Vector2d a = h * (line[i] - Vector2d(g.width / 2, 0.5)),
                           b = h * (line[i + 1] - Vector2d(g.width / 2, 0.5));
            const int n = std::max(1, static_cast<int>(std::ceil((b - a).norm() / settings.max_segment_mm)));
            for (int k = i == 0 ? 0 : 1; k <= n; ++k)
                if (const auto p = on_skin(skin, f, a + (b - a) * k / n)) points.push_back(*p);
        }
        add_stroke(points, item, 0.11 * h, strokes);
    }
}

std::vector<Stroke> draw_text(const SkinSurface& skin, const TextFrame& frame, const TextBlock& block,
                              const DrawingSettings& settings, int item) {
    std::vector<Stroke> strokes;
    const double h = settings.text_height_mm;
    double y = block.height_mm / 2 - h / 2;  // middle of the first line's capitals
    for (const auto& line : block.lines) {
        double x = -text_width(line) * h / 2;
        for (const char32_t code : line) {
            const Glyph g = glyph(code);
            draw_glyph(skin, frame, g, {x + g.width * h / 2, y}, settings, item, strokes);
            x += g.advance * h;
        }
        y -= kLineSpacing * h;
    }
    return strokes;
}

/// How far the middle of a text must be from a point so that its outline is clear of it in direction `angle`.
double reach_mm(const TextBlock& block, double angle) {
    const double c = std::abs(std::cos(angle)), s = std::abs(std::sin(angle));
    return std::min(c > 1e-9 ? block.width_mm / 2 / c : 1e9, s > 1e-9 ? block.height_mm / 2 / s : 1e9);
}

/// The best place at `gap_mm` beyond what is drawn at the anchors.
void try_ring(const LabelWish& wish, const SkinSurface& skin, const DrawingSettings& settings,
              const OccupiedSkin& occupied, const TextBlock& block, double gap_mm, Candidate& best) {
    constexpr int kDirections = 16;
    for (std::size_t a = 0; a < wish.anchors.size(); ++a) {
        const TextFrame at_anchor = text_frame(wish.anchors[a], settings.up_in_ct);
        for (int d = 0; d < kDirections; ++d) {
            const double angle = 2 * std::numbers::pi * d / kDirections;
            const double way_mm = wish.keep_off_mm + kClear_mm + 0.8 + gap_mm + reach_mm(block, angle);
            const auto middle = on_skin(skin, at_anchor, way_mm * Vector2d(std::cos(angle), std::sin(angle)));
            if (!middle) continue;
            const Vector3d& from = wish.anchors[a].p_in_ct;
            double cost = gap_mm + 0.3 * static_cast<double>(a) + 2 * std::abs(std::sin(angle)) +
                          (std::cos(angle) < -0.1 ? 0.5 : 0) +
                          30 * (1 - middle->normal_in_ct.dot(wish.facing_in_ct.value_or(wish.anchors[a].normal_in_ct)));
            if (wish.away_from_in_ct &&
                (middle->p_in_ct - *wish.away_from_in_ct).norm() < (from - *wish.away_from_in_ct).norm())
                cost += 15;
            if (best.overlaps == 0 && cost >= best.cost) continue;
            const TextFrame frame = text_frame(*middle, settings.up_in_ct);
            const int overlaps = count_overlaps(skin, frame, block, occupied, best.overlaps + 1);
            if (overlaps < best.overlaps || (overlaps == best.overlaps && cost < best.cost))
                best = {frame, cost, overlaps, gap_mm, wish.anchors[a]};
        }
    }
}

/// A thin line from what is named to the text, when they are far apart.
void add_leader(const SkinSurface& skin, const LabelWish& wish, const Candidate& chosen, const TextBlock& block,
                const DrawingSettings& settings, std::vector<Stroke>& strokes) {
    if (chosen.gap_mm < 6) return;
    const SkinLine line = straight_way(skin, chosen.anchor, chosen.frame.at, settings.max_segment_mm);
    std::vector<Point> points;
    for (const Point& p : line.points) {
        const Vector3d from_text = p.p_in_ct - chosen.frame.at.p_in_ct;
        const bool in_text = std::abs(from_text.dot(chosen.frame.right_in_ct)) < block.width_mm / 2 + 1.2 &&
                             std::abs(from_text.dot(chosen.frame.up_in_ct)) < block.height_mm / 2 + 1.2;
        if (!in_text && (p.p_in_ct - chosen.anchor.p_in_ct).norm() > wish.keep_off_mm + 0.8) points.push_back(p);
    }
    add_stroke(points, wish.item, 0.4, strokes);
}

}  // namespace

std::int64_t OccupiedSkin::key(const Eigen::Vector3i& cell) {
    return (static_cast<std::int64_t>(cell.x()) * 2097169 + cell.y()) * 2097169 + cell.z();
}

void OccupiedSkin::add(const Vector3d& p_in_ct) {
    auto& cell = cells_[key((p_in_ct / kCell_mm).array().floor().cast<int>())];
    // Where a crowded plan is drawn over itself a cell would grow without end, and each look into it with it.
    constexpr double kSame_mm = 0.2;
    for (const Vector3d& q : cell)
        if ((q - p_in_ct).squaredNorm() < kSame_mm * kSame_mm) return;
    cell.push_back(p_in_ct);
}

bool OccupiedSkin::within(const Vector3d& p_in_ct, double distance_mm) const {
    const Eigen::Vector3i cell = (p_in_ct / kCell_mm).array().floor().cast<int>();
    for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
            for (int dz = -1; dz <= 1; ++dz) {
                const auto found = cells_.find(key(cell + Eigen::Vector3i(dx, dy, dz)));
                if (found == cells_.end()) continue;
                for (const Vector3d& q : found->second)
                    if ((q - p_in_ct).squaredNorm() < distance_mm * distance_mm) return true;
            }
    return false;
}

TextBlock lay_out(const std::string& text, double text_height_mm) {
    TextBlock block;
    std::size_t from = 0;
    while (from <= text.size()) {
        const auto two_blanks = std::min(text.find("  ", from), text.size());
        const std::u32string part = code_points(text.substr(from, two_blanks - from));
        const bool joins =
            !block.lines.empty() && text_width(block.lines.back() + U" " + part) * text_height_mm < 0.75 * kMaxWidth_mm;
        if (joins)
            block.lines.back() += U" " + part;
        else
            add_wrapped(part, text_height_mm, block.lines);
        from = two_blanks + 2;
    }
    for (const auto& line : block.lines) block.width_mm = std::max(block.width_mm, text_width(line) * text_height_mm);
    block.height_mm = text_height_mm * (1 + kLineSpacing * (static_cast<double>(block.lines.size()) - 1));
    return block;
}

TextFrame text_frame(const Point& at, const Vector3d& up_in_ct) {
    const auto tangent = [&](const Vector3d& v) { return Vector3d(v - v.dot(at.normal_in_ct) * at.normal_in_ct); };
    Vector3d up = tangent(up_in_ct.normalized());
    if (up.norm() <
        0.25) {  // on top of the head: read by someone who stands before the face (ct is LPS: +y is posterior)
        const Vector3d back = std::abs(up_in_ct.normalized().y()) > 0.9 ? Vector3d(0, 0, -1) : Vector3d(0, 1, 0);
        up = tangent(at.normal_in_ct.dot(up_in_ct) > 0 ? back : Vector3d(-back));
    }
    up.normalize();
    return {at, up.cross(at.normal_in_ct), up};
}

std::vector<Stroke> place_label(const LabelWish& wish, const SkinSurface& skin, const DrawingSettings& settings,
                                OccupiedSkin& occupied) {
    const TextBlock block = lay_out(wish.text, settings.text_height_mm);
    Candidate best;
    for (const double gap_mm : {0.0, 3.0, 7.0, 12.0, 18.0, 26.0}) {
        try_ring(wish, skin, settings, occupied, block, gap_mm, best);
        if (best.overlaps == 0) break;
    }
    if (best.frame.at.triangle < 0) return {};
    std::vector<Stroke> strokes = draw_text(skin, best.frame, block, settings, wish.item);
    add_leader(skin, wish, best, block, settings, strokes);
    for (const Stroke& stroke : strokes)
        for (const Vector3d& p : stroke.points_in_ct) occupied.add(p);
    return strokes;
}

}  // namespace planlight
