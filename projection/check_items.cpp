#include "projection/check_items.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planning_io/types/even_direction.h"
#include "projection/line_crossing.h"

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
    /// A place on an axis, or the nearest where there is none.
    void check_place(const char* what, const PlaceOnSkin& place, bool axis, const SkinSurface& skin,
                     const DrawingSettings& s) {
        if (const auto why = no_place(skin, place, what, axis)) return add("{}; it is not drawn", *why);
        if (axis && place.aside_mm > kToldAside_mm)
            add("its axis does not meet the skin within {:.0f} mm of {}; it is drawn {:.1f} mm beside the axis",
                kMostAlong_mm, what, place.aside_mm);
        else if (place.aside_mm > kToldAside_mm)
            add("{} lies {:.1f} mm beyond the border of the surface; it is drawn at the border", what, place.aside_mm);
        else if (place.along_mm > s.max_distance_to_skin_mm)
            add("its axis meets the skin {:.1f} mm from {} (at most {:.0f} mm expected)", place.along_mm, what,
                s.max_distance_to_skin_mm);
        if (flag_at(skin, place.at) == kSeal)
            add("{} comes to lie on a lid over an opening (mouth, nostril, ear), where the scan shows no skin", what);
    }
    void check_ring(const SkinSurface& skin, const SkinSurface::Point& at, double radius_mm, const DrawingSettings& s) {
        const RingOnSkin ring = ring_on_skin(skin, at, radius_mm, s.max_segment_mm);
        if (ring.beyond > kSomeOfARing)
            add("{:.0f} % of its ring lies beyond the border of the surface, and is drawn along that",
                100 * ring.beyond);
        if (ring.at_end > kSomeOfARing)
            add("{:.0f} % of its ring lies on the end of the volume, where the scan ends and shows no skin",
                100 * ring.at_end);
        if (ring.on_lids > kMuchOfARing)
            add("{:.0f} % of its ring lies on a lid over an opening (mouth, nostril, ear), where the scan shows no "
                "skin",
                100 * ring.on_lids);
        if (ring.beyond > kSomeOfARing) return;
        if (ring.widest_step_mm > torn_mm(s))
            add("its ring is torn by folds of the skin: two neighbouring points of it lie {:.1f} mm apart",
                ring.widest_step_mm);
        else if (ring.narrowest < kBent)
            add("the skin bends so much under its ring of {:.1f} mm along the skin that this is only {:.1f} mm across",
                2 * radius_mm, 2 * radius_mm * ring.narrowest);
    }
    void check_way(const OsteotomyLine& line, const SkinSurface& skin, const DrawingSettings& s) {
        double end_mm = 0, lids_mm = 0, step_mm = 0, most = 0, leg_mm = 0, chord_mm = 0;
        std::size_t from = 0, to = 0;
        const std::size_t count = line.points_in_ct.size();
        LineCrossing crossing;
        for (std::size_t i = 0; i + (line.closed && count > 2 ? 0 : 1) < count; ++i) {
            const auto a = skin.nearest(line.points_in_ct[i]), b = skin.nearest(line.points_in_ct[(i + 1) % count]);
            const SkinLine leg = join(skin, {a, b}, false, s.max_segment_mm);
            const LineOnSkin look = look_at(skin, leg);
            const double mm = length_mm(leg), straight_mm = (a.p_in_ct - b.p_in_ct).norm();
            crossing.add(leg, i);
            end_mm += look.at_end * mm;
            lids_mm += look.on_lids * mm;
            step_mm = std::max(step_mm, look.widest_step_mm);
            const double more = mm - kRoundAHead * straight_mm;
            if (more > most) most = more, leg_mm = mm, chord_mm = straight_mm, from = i + 1, to = (i + 1) % count + 1;
        }
        check_ends(end_mm, lids_mm);
        if (const auto legs = crossing.first(line.closed))
            add("it crosses itself: its way from point {} to {} and that from {} to {} meet; are its points in the "
                "right order?",
                legs->first + 1, (legs->first + 1) % count + 1, legs->second + 1, (legs->second + 1) % count + 1);
        if (step_mm > torn_mm(s))
            add("it jumps {:.1f} mm where the skin has a fold or a border, and is not on the skin there", step_mm);
        else if (most > kDetour_mm)
            add("from its point {} to {} it runs {:.0f} mm over the skin, though they are {:.0f} mm apart; set points "
                "between them where that is not meant",
                from, to, leg_mm, chord_mm);
    }
    void check_ends(double end_mm, double lids_mm) {
        if (end_mm > kSomeOfALine_mm)
            add("{:.0f} mm of it run over the end of the volume, where the scan ends and shows no skin", end_mm);
        if (lids_mm > kMuchOfALine_mm)
            add("{:.0f} mm of it run over lids over openings (mouth, nostril, ear), where the scan shows no skin",
                lids_mm);
    }
    std::vector<std::string> sentences() { return std::move(sentences_); }

private:
    static constexpr double kSomeOfARing = 0.02, kMuchOfARing = 0.1, kSomeOfALine_mm = 1, kMuchOfALine_mm = 3;
    static constexpr double kBent = 0.85;
    static constexpr double kRoundAHead = 1.3, kDetour_mm = 5;  // a way half round a head is 1.57 times its chord
    static double torn_mm(const DrawingSettings& s) { return std::max(3.0, 6 * s.max_segment_mm); }

    std::string name_;
    std::vector<std::string> sentences_;
};

double distance_mm(const SkinSurface& skin, const Vector3d& p) {
    return (skin.nearest(p).p_in_ct - p).norm();
}

bool too_far(double distance_mm, const DrawingSettings& s) {
    return distance_mm > kTooFarFactor * s.max_distance_to_skin_mm;
}

bool points_out(const Borehole& b, const SkinSurface& skin) {
    return b.axis_in_ct && b.axis_in_ct->dot(skin.nearest(b.position_in_ct).normal_in_ct) > 0;
}

}  // namespace

bool in_the_body(const SkinSurface& skin, const Vector3d& p) {
    if (skin.inside(p)) return true;
    constexpr int kWays = 96;
    int ended = 0;
    for (int i = 0; i < kWays; ++i) ended += skin.first_hit({p, even_direction(i, kWays)}).has_value();
    return 4 * ended >= 3 * kWays;
}

std::optional<std::string> no_place_of(const Trajectory& t, const SkinSurface& skin) {
    return no_place(skin, place_of(t, skin, skin), "its entry", true);
}

std::optional<std::string> no_place_of(const Borehole& b, const SkinSurface& skin) {
    return no_place(skin, place_of(b, skin, skin), "its position", has_axis(b));
}

std::optional<std::string> no_place_of(const OsteotomyLine& o, const SkinSurface& skin) {
    for (const Vector3d& p : o.points_in_ct)
        if (auto why = no_place(skin, place_nearest(skin, p), "a point of it", false)) return why;
    return std::nullopt;
}

bool is_plane(const CutPlane& c) {
    return finite(c) && std::abs(c.normal_in_ct.norm() - 1) < 1e-3 && std::abs(c.first_axis_in_ct.norm() - 1) < 1e-3 &&
           std::abs(c.normal_in_ct.dot(c.first_axis_in_ct)) < 1e-3;
}

std::vector<std::string> faults(const Trajectory& t, const SkinSurface& skin, const DrawingSettings& s) {
    Faults f("trajectory", t.name);
    if (!finite(t)) {
        f.add("its points are not finite; it is not drawn");
        return f.sentences();
    }
    const double entry_mm = distance_mm(skin, t.entry_in_ct);
    f.check_distance("its entry", entry_mm, s);
    if (!too_far(entry_mm, s)) {
        const PlaceOnSkin place = place_of(t, skin, skin);
        f.check_place("its entry", place, true, skin, s);
        if (!no_place(skin, place, "", true)) f.check_ring(skin, place.at, ring_radius_mm(t), s);
    }
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
    const double position_mm = distance_mm(skin, b.position_in_ct);
    f.check_distance("its position", position_mm, s);
    if (!too_far(position_mm, s)) {
        const PlaceOnSkin place = place_of(b, skin, skin);
        f.check_place("its position", place, has_axis(b), skin, s);
        if (b.diameter_mm > 0 && !no_place(skin, place, "", true)) f.check_ring(skin, place.at, b.diameter_mm / 2, s);
    }
    if (!(b.diameter_mm > 0)) f.add("it has no diameter; only its centre is drawn");
    if (b.diameter_mm > 60) f.add("its diameter of {:.0f} mm is larger than any drill's", b.diameter_mm);
    if (!(b.depth_mm > 0)) f.add("it has no depth");
    if (points_out(b, skin)) f.add("its axis points out of the body");
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
    if (!too_far(far_mm, s)) {
        PlaceOnSkin worst;
        for (const Vector3d& p : o.points_in_ct) {
            const PlaceOnSkin place = place_nearest(skin, p);
            if (worst.at.triangle < 0 || place.aside_mm > worst.aside_mm ||
                flag_at(skin, place.at) > flag_at(skin, worst.at))
                worst = place;
        }
        if (const auto why = no_place_of(o, skin))
            f.add("{}; it is not drawn", *why);
        else if (worst.at.triangle >= 0) {
            f.check_place("a point of it", worst, false, skin, s);
            f.check_way(o, skin, s);
        }
    }
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
    if (!is_plane(c)) {
        f.add("its axes are not unit length and square to each other; it is not drawn");
        return f.sentences();
    }
    const std::vector<SkinLine> lines = trace(skin, c, s.max_segment_mm);
    const double end_mm = trace_at_end_mm(skin, c);
    if (lines.empty() && end_mm >= 1)
        f.add("within its extent of {:.0f} x {:.0f} mm it meets only the end of the volume, no skin", c.width_mm,
              c.height_mm);
    else if (lines.empty())
        f.add("it does not meet the skin within its extent of {:.0f} x {:.0f} mm", c.width_mm, c.height_mm);
    else if (end_mm >= 1)
        f.add("its cut reaches the end of the volume, where the scan ends: it is drawn and measured up to there");
    double lids_mm = 0;
    for (const SkinLine& line : lines) lids_mm += look_at(skin, line).on_lids * length_mm(line);
    f.check_ends(0, lids_mm);
    return f.sentences();
}

}  // namespace planlight
