#include "projection/stroke_places.h"

#include <Eigen/Geometry>
#include <cmath>
#include <unordered_map>

namespace planlight {
namespace {

using Eigen::Vector3d;

/// Points of all strokes by cubes, to find what lies near a place.
class StrokesNear {
public:
    StrokesNear(const PlanDrawing& drawing, double reach_mm) : drawing_(drawing), reach_mm_(reach_mm) {
        for (std::size_t s = 0; s < drawing.strokes.size(); ++s)
            for (const Vector3d& p : drawing.strokes[s].points_in_ct) cells_[key(cell(p))].push_back({s, p});
        for (const Label& label : drawing.labels) {
            for (const Label::Outlines& sign : label.signs_in_ct)
                for (const auto& outline : sign)
                    for (const Vector3d& p : outline) cells_[key(cell(p))].push_back({kLabel, p});
            for (const Vector3d& p : label.leader.points_in_ct) cells_[key(cell(p))].push_back({kLabel, p});
        }
    }
    /// How far to both sides of a place no light but this stroke's is wanted, mm, at most the reach: another stroke, or
    /// a part of the same that comes back beside itself.
    double free_mm(std::size_t stroke, const StrokePlace& at) const {
        double free_mm = reach_mm_;
        double line_to_left_mm = 0, line_to_right_mm = 0;
        each_near(at.p_in_ct, [&](std::size_t other, const Vector3d& p) {
            if (!crossed_by(stroke, other)) {
                free_mm = std::min(free_mm, free_of_mm(other, p, stroke, at));
                return;
            }
            const Vector3d way = p - at.p_in_ct;
            const double aside_mm = way.dot(at.sideways_in_ct), along_mm = std::abs(way.dot(at.along_in_ct));
            if (along_mm < kBesideLine * at.width_mm) free_mm = 0;
            line_to_left_mm = std::max(line_to_left_mm, -aside_mm);
            line_to_right_mm = std::max(line_to_right_mm, aside_mm);
        });
        if (drawing_.strokes[stroke].kind == StrokeKind::tick)
            free_mm = std::min({free_mm, line_to_left_mm, line_to_right_mm});
        return free_mm;
    }

    /// The same of other items' strokes alone, whose light could be mistaken for this one's.
    double free_of_items_mm(std::size_t stroke, const StrokePlace& at) const {
        double free_mm = reach_mm_;
        each_near(at.p_in_ct, [&](std::size_t other, const Vector3d& p) {
            if (other == kLabel || drawing_.strokes[other].item == drawing_.strokes[stroke].item) return;
            free_mm = std::min(free_mm, free_of_mm(other, p, stroke, at));
        });
        return free_mm;
    }

private:
    static constexpr std::size_t kLabel = static_cast<std::size_t>(-1);  // in place of a stroke's number
    static constexpr double kLabelLine_mm = 0.5;                         // what its outline is taken to be wide
    static constexpr double kBesideLine = 0.75;  // of the width: a tick's arm begins so far from the middle of its line

    /// True of a tick and the line that it is a tick of.
    bool crossed_by(std::size_t tick, std::size_t line) const {
        if (line == kLabel) return false;
        const Stroke &a = drawing_.strokes[tick], &b = drawing_.strokes[line];
        return a.kind == StrokeKind::tick && a.item == b.item &&
               (b.kind == StrokeKind::osteotomy_line || b.kind == StrokeKind::cut_plane);
    }
    template <class Visit>
    void each_near(const Vector3d& at, Visit visit) const {
        const Eigen::Vector3i middle = cell(at);
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z) {
                    const auto found = cells_.find(key(middle + Eigen::Vector3i(x, y, z)));
                    if (found == cells_.end()) continue;
                    for (const auto& [other, p] : found->second) visit(other, p);
                }
    }
    double free_of_mm(std::size_t other, const Vector3d& p, std::size_t stroke, const StrokePlace& at) const {
        const Vector3d way = p - at.p_in_ct;
        const double widths_mm = (at.width_mm + width_mm(other)) / 2;
        const double aside_mm = std::abs(way.dot(at.sideways_in_ct)), along_mm = std::abs(way.dot(at.along_in_ct));
        if (along_mm > 2 * widths_mm || way.norm() > 2 * reach_mm_) return reach_mm_;
        if (other == stroke && aside_mm < 2 * widths_mm) return reach_mm_;  // the stroke itself
        return aside_mm - widths_mm;
    }
    double width_mm(std::size_t stroke) const {
        return stroke == kLabel ? kLabelLine_mm : drawing_.strokes[stroke].width_mm;
    }
    Eigen::Vector3i cell(const Vector3d& p) const { return (p / reach_mm_).array().floor().matrix().cast<int>(); }
    static std::int64_t key(const Eigen::Vector3i& c) {
        return ((static_cast<std::int64_t>(c.x()) * 2097152) + c.y()) * 2097152 + c.z();
    }
    struct Near {
        std::size_t stroke;
        Vector3d p;
    };
    const PlanDrawing& drawing_;
    double reach_mm_;
    std::unordered_map<std::int64_t, std::vector<Near>> cells_;
};

}  // namespace

std::vector<StrokePlace> places_along(const Stroke& stroke, double spacing_mm) {
    std::vector<StrokePlace> places;
    const std::size_t n = stroke.points_in_ct.size(), segments = stroke.closed ? n : n - 1;
    constexpr double kBesideGap_mm = 0.7;  // light that ends is not the same all along the profile
    double wait_mm = 0, way_mm = 0;
    for (std::size_t i = 0; n > 1 && i < segments; ++i) {
        const Vector3d a = stroke.points_in_ct[i], way = stroke.points_in_ct[(i + 1) % n] - a;
        const double length_mm = way.norm();
        if (length_mm < 1e-9) continue;
        for (; wait_mm < length_mm; wait_mm += spacing_mm) {
            StrokePlace place;
            place.p_in_ct = a + way * (wait_mm / length_mm);
            place.normal_in_ct = stroke.normals_in_ct[i];
            place.sideways_in_ct = place.normal_in_ct.cross(way / length_mm).normalized();
            place.along_in_ct = place.sideways_in_ct.cross(place.normal_in_ct);
            place.width_mm = stroke.width_mm;
            place.lit = !stroke.in_gap(way_mm + wait_mm, kBesideGap_mm);
            places.push_back(place);
        }
        wait_mm -= length_mm;
        way_mm += length_mm;
    }
    return places;
}

bool freely_seen(const StrokePlace& place, const SkinSurface& skin, const CameraModel& device,
                 const RigidTransform& rig_from_ct, double steepest) {
    constexpr double kOffSkin_mm = 1.5;  // the stroke may lie a little in the mesh
    const auto pixel = project(device, rig_from_ct * place.p_in_ct);
    if (!pixel || !in_picture(device, *pixel)) return false;
    const Vector3d way = rig_from_ct.inverse() * device.centre_in_rig() - place.p_in_ct;
    const Vector3d direction = way.normalized();
    if (place.normal_in_ct.dot(direction) < std::cos(steepest)) return false;
    return !skin.first_hit({place.p_in_ct + kOffSkin_mm * place.normal_in_ct, direction});
}

namespace {

void add_segments(const PlanDrawing& drawing, std::size_t s, const StrokesNear& near,
                  const CheckLightSettings& settings, std::vector<StrokeSegment>& segments) {
    const Stroke& stroke = drawing.strokes[s];
    const bool tick = stroke.kind == StrokeKind::tick;
    const double spacing_mm = tick ? settings.spacing_mm / 2 : settings.spacing_mm;
    const std::vector<StrokePlace> places = places_along(stroke, spacing_mm);
    const bool small = stroke.closed || static_cast<double>(places.size()) * spacing_mm < 3 * settings.segment_mm;
    const double most_mm = small ? settings.segment_mm / 2 : settings.segment_mm;
    const auto most = static_cast<std::size_t>(std::max(1.0, most_mm / settings.spacing_mm));
    const StrokeSegment none{stroke.item, tick, {}, settings.search_mm};
    StrokeSegment segment = none;
    const auto close = [&](std::size_t least) {
        if (segment.places.size() >= least) segments.push_back(segment);
        segment = none;
    };
    for (const StrokePlace& place : places) {
        const double free_mm = place.lit ? near.free_mm(s, place) : 0;
        if (free_mm < settings.least_search_mm) {
            if (!tick) close((most + 1) / 2);
            continue;
        }
        segment.search_mm = std::min(segment.search_mm, free_mm);
        segment.places.push_back(place);
        if (segment.places.size() >= most && !tick) close((most + 1) / 2);
    }
    constexpr std::size_t kArms = 4;  // places of a tick, both arms together
    close(tick ? kArms : (most + 1) / 2);
}

}  // namespace

std::vector<std::optional<StrokePlace>> places_of_items(const PlanDrawing& drawing) {
    std::vector<std::optional<StrokePlace>> places(drawing.items.size());
    std::vector<std::size_t> longest(drawing.items.size(), 0);
    for (const Stroke& stroke : drawing.strokes) {
        if (stroke.kind == StrokeKind::label || stroke.kind == StrokeKind::check_mark || stroke.item < 0) continue;
        const auto item = static_cast<std::size_t>(stroke.item);
        const std::vector<StrokePlace> all = places_along(stroke, 0.5);
        if (all.size() <= longest[item]) continue;
        longest[item] = all.size();
        places[item] = all[all.size() / 2];
    }
    return places;
}

namespace {

/// Of a small figure, a hole say, what is seen stands for all of it: no skin rises under a few millimetres alone.
bool is_small(const Stroke& stroke) {
    constexpr double kSmall_mm = 25;
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : stroke.points_in_ct) box.extend(p);
    return box.isEmpty() || box.diagonal().norm() < kSmall_mm;
}

}  // namespace

std::vector<double> extents_of_items_mm(const PlanDrawing& drawing) {
    std::vector<Eigen::AlignedBox3d> boxes(drawing.items.size());
    for (const Stroke& stroke : drawing.strokes)
        if (stroke.kind != StrokeKind::label && stroke.item >= 0)
            for (const Vector3d& p : stroke.points_in_ct) boxes[static_cast<std::size_t>(stroke.item)].extend(p);
    std::vector<double> extents_mm;
    for (const Eigen::AlignedBox3d& box : boxes) extents_mm.push_back(box.isEmpty() ? 0 : box.diagonal().norm());
    return extents_mm;
}

std::vector<StrokeSegment> crowded_segments_of(const PlanDrawing& drawing, const std::vector<StrokeSegment>& segments,
                                               const CheckLightSettings& settings) {
    const StrokesNear near(drawing, settings.search_mm);
    const auto most = static_cast<std::size_t>(std::max(1.0, settings.segment_mm / settings.spacing_mm));
    std::vector<bool> told(drawing.items.size(), false);
    for (const StrokeSegment& segment : segments) told[static_cast<std::size_t>(segment.item)] = true;
    std::vector<StrokeSegment> crowded;
    for (std::size_t s = 0; s < drawing.strokes.size(); ++s) {
        const Stroke& stroke = drawing.strokes[s];
        if (stroke.kind == StrokeKind::label || stroke.kind == StrokeKind::tick ||
            stroke.kind == StrokeKind::check_mark || stroke.item < 0 || is_small(stroke) ||
            !told[static_cast<std::size_t>(stroke.item)])
            continue;
        StrokeSegment segment{stroke.item, false, {}, 0};
        for (const StrokePlace& place : places_along(stroke, settings.spacing_mm)) {
            if (!place.lit || near.free_of_items_mm(s, place) >= settings.least_search_mm) continue;
            segment.places.push_back(place);
            if (segment.places.size() < most) continue;
            crowded.push_back(segment);
            segment.places.clear();
        }
        if (2 * segment.places.size() > most) crowded.push_back(segment);
    }
    return crowded;
}

std::vector<StrokeSegment> segments_of(const PlanDrawing& drawing, const CheckLightSettings& settings) {
    const StrokesNear near(drawing, settings.search_mm);
    std::vector<StrokeSegment> segments;
    for (std::size_t s = 0; s < drawing.strokes.size(); ++s)
        if (drawing.strokes[s].kind != StrokeKind::label) add_segments(drawing, s, near, settings, segments);
    return segments;
}

}  // namespace planlight
