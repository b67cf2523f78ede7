#include "projection/check_marks.h"

#include <Eigen/Eigenvalues>

#include "projection/place_labels.h"
#include "projection/skin_paths.h"
#include "projection/stroke_places.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kOfLine = 0.7;  // a mark's width, of a line's
constexpr double kOwn_mm = 1.8;  // to the item's own strokes: the cameras take 1.6 for apart (`segments_of`)
constexpr double kOther_mm = 3;  // to all other light

/// Skin that is lit for others, or kept clear.
OccupiedSkin occupied_by(const PlanDrawing& drawing, const SkinSurface& skin, const DrawingSettings& settings) {
    OccupiedSkin occupied;
    for (const Stroke& stroke : drawing.strokes)
        for (const Vector3d& p : stroke.points_in_ct) occupied.add(p, stroke.item);
    const auto add = [&](const Label& label) {
        for (const Vector3d& p : label.field_in_ct) occupied.add(p);
        for (const Vector3d& p : label.leader.points_in_ct) occupied.add(p);
    };
    for (const Label& label : drawing.labels) add(label);
    if (drawing.card) add(*drawing.card);
    occupy_kept_clear(skin, settings, occupied);
    return occupied;
}

/// True where the mark comes near what is drawn of its own item.
bool touches_own(const Stroke& mark, const PlanDrawing& drawing) {
    for (const Stroke& stroke : drawing.strokes) {
        if (stroke.item != mark.item) continue;
        for (const Vector3d& p : stroke.points_in_ct)
            for (const Vector3d& q : mark.points_in_ct)
                if ((p - q).squaredNorm() < kOwn_mm * kOwn_mm) return true;
    }
    return false;
}

}  // namespace

std::vector<bool> untold_items(const PlanDrawing& drawing) {
    constexpr int kStretches = 6;
    constexpr double kWorseDirection = 1.5;  // stretches square to it
    std::vector<int> stretches(drawing.items.size(), 0);
    std::vector<Matrix3d> sides(drawing.items.size(), Matrix3d::Zero());
    for (const StrokeSegment& segment : segments_of(drawing, {})) {
        const auto item = static_cast<std::size_t>(segment.item);
        const Vector3d& sideways = segment.middle().sideways_in_ct;
        ++stretches[item];
        sides[item] += sideways * sideways.transpose();
    }
    std::vector<bool> untold;
    for (std::size_t i = 0; i < drawing.items.size(); ++i) {
        const Eigen::SelfAdjointEigenSolver<Matrix3d> told(sides[i], Eigen::EigenvaluesOnly);
        untold.push_back(stretches[i] < kStretches || told.eigenvalues()[1] < kWorseDirection);
    }
    return untold;
}

void add_check_marks(const std::vector<MarkPlace>& places, const SkinSurface& skin, const DrawingSettings& settings,
                     PlanDrawing& drawing) {
    const std::vector<bool> untold = untold_items(drawing);
    OccupiedSkin occupied = occupied_by(drawing, skin, settings);
    for (const MarkPlace& place : places) {
        if (!untold[static_cast<std::size_t>(place.item)]) continue;
        int left = place.wanted;
        for (const MarkPlace::Ray& ray : place.rays) {
            if (left == 0) break;
            const SkinLine line = bar(skin, place.at, ray.direction_in_ct, -ray.from_mm, ray.from_mm + place.length_mm,
                                      settings.max_segment_mm);
            if (length_mm(line) < 0.9 * place.length_mm) continue;  // the skin ends there
            Stroke mark{
                StrokeKind::check_mark, place.item, place.colour, kOfLine * settings.line_width_mm, false, {}, {}};
            bool clear = true;
            for (const SkinSurface::Point& p : line.points) {
                clear = clear && !occupied.within(p.p_in_ct, kOther_mm, place.item);
                mark.points_in_ct.push_back(p.p_in_ct);
                mark.normals_in_ct.push_back(p.normal_in_ct);
            }
            if (!clear || touches_own(mark, drawing)) continue;
            for (const Vector3d& p : mark.points_in_ct) occupied.add(p, place.item);
            drawing.strokes.push_back(std::move(mark));
            --left;
        }
    }
}

}  // namespace planlight
