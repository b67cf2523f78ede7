#include "projection/darkness_check.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

/// Farthest that a point of the drawing lies from where it lay.
double moved_mm(const PlanDrawing& drawing, const RigidTransform& from, const RigidTransform& to) {
    double most = 0;
    for (const Stroke& stroke : drawing.strokes)
        for (const auto& p : stroke.points_in_ct) most = std::max(most, (to * p - from * p).norm());
    return most;
}

Stroke without_points(const Stroke& stroke) {
    Stroke bare = stroke;
    bare.points_in_ct.clear();
    bare.normals_in_ct.clear();
    return bare;
}

}  // namespace

double light_grey(const LightCheck& check) {
    std::vector<double> grey;
    for (const SeenSegment& segment : check.segments)
        if (segment.seen) grey.push_back(segment.brighter * segment.background);
    return grey.empty() ? 0 : quantile(grey, 0.5);
}

PlanDrawing light_on_moved_head(const PlanDrawing& drawing, const SkinSurface& skin, const CameraModel& projector,
                                const RigidTransform& rig_from_ct_then, const RigidTransform& rig_from_ct_now) {
    PlanDrawing moved;
    moved.items = drawing.items;
    const RigidTransform ct_from_rig = rig_from_ct_now.inverse();
    const RigidTransform now_from_then = ct_from_rig * rig_from_ct_then;  // ct to ct, of what stays in the rig
    const Eigen::Vector3d centre = ct_from_rig * projector.centre_in_rig();
    for (const Stroke& stroke : drawing.strokes) {
        Stroke piece = without_points(stroke);
        bool whole = true;
        const auto end_piece = [&] {
            piece.closed = stroke.closed && whole;
            if (piece.points_in_ct.size() > 1) moved.strokes.push_back(piece);
            piece = without_points(stroke);
        };
        for (const auto& p : stroke.points_in_ct) {
            const auto hit = skin.first_hit({centre, (now_from_then * p - centre).normalized()});
            if (!hit) {
                whole = false;
                end_piece();
                continue;
            }
            piece.points_in_ct.push_back(hit->p_in_ct);
            piece.normals_in_ct.push_back(hit->normal_in_ct);
        }
        end_piece();
    }
    return moved;
}

DarknessCheck::DarknessCheck(PlanDrawing lit, const SkinSurface& skin, const RigCalibration& rig,
                             const RigidTransform& rig_from_ct_when_lit, double grey_when_lit,
                             const CheckLightSettings& look, std::optional<std::size_t> bright_item,
                             const DarknessSettings& settings)
    : drawing_(std::move(lit)),
      skin_(skin),
      rig_(rig),
      when_lit_(rig_from_ct_when_lit),
      stands_at_(rig_from_ct_when_lit),
      grey_when_lit_(grey_when_lit),
      look_(look),
      bright_item_(bright_item),
      settings_(settings) {
    look_.far_too = false;
}

void DarknessCheck::stand_at(const RigidTransform& rig_from_ct) {
    if (checker_ && moved_mm(drawing_, stands_at_, rig_from_ct) < settings_.moved_mm) return;
    stands_at_ = rig_from_ct;
    const bool moved = moved_mm(drawing_, when_lit_, rig_from_ct) >= settings_.moved_mm;
    checker_.emplace(moved ? light_on_moved_head(drawing_, skin_, rig_.projector, when_lit_, rig_from_ct) : drawing_,
                     skin_, rig_, look_, bright_item_);
}

bool DarknessCheck::look(const StereoFrame& frame, const std::optional<RigidTransform>& rig_from_ct) {
    stand_at(rig_from_ct.value_or(when_lit_));
    const LightCheck check = checker_->look(stands_at_, frame);
    const bool seen = check.seen >= settings_.least_seen && check.seen_share() >= settings_.least_seen_share &&
                      light_grey(check) >= settings_.least_of_light * grey_when_lit_;
    seen_running_ = seen ? seen_running_ + 1 : 0;
    return lit();
}

}  // namespace planlight
