#include "projection/darkness_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

/// Behind the items of `drawing`, whose numbers stay.
void add_behind(PlanDrawing& drawing, const PlanDrawing& other) {
    const int first = static_cast<int>(drawing.items.size());
    drawing.items.insert(drawing.items.end(), other.items.begin(), other.items.end());
    for (Stroke stroke : other.strokes) {
        if (stroke.item >= 0) stroke.item += first;
        drawing.strokes.push_back(std::move(stroke));
    }
    for (Label label : other.labels) {
        if (label.item >= 0) label.item += first;
        drawing.labels.push_back(std::move(label));
    }
}

/// What a check saw of some items.
struct SeenLight {
    int expected = 0, seen = 0;  ///< stretches
    double grey = 0;             ///< `light_grey`
    double most_off_mm = 0;
};

SeenLight seen_of_first(const LightCheck& check, std::size_t items) {
    SeenLight result;
    std::vector<double> grey;
    for (const SeenSegment& segment : check.segments) {
        if (segment.item >= static_cast<int>(items)) continue;
        result.expected += !segment.tick || segment.seen ? 1 : 0;
        if (!segment.seen) continue;
        ++result.seen;
        result.most_off_mm = std::max(result.most_off_mm, std::abs(segment.off_mm));
        grey.push_back(segment.brighter * segment.background);
    }
    result.grey = grey.empty() ? 0 : quantile(std::move(grey), 0.5);
    return result;
}

bool is_the_light(const SeenLight& looked, double grey_when_lit, const DarknessSettings& settings) {
    if (looked.seen == 0 || looked.seen < settings.least_seen_share * looked.expected) return false;
    if (looked.grey < settings.least_of_light * grey_when_lit) return false;
    if (looked.seen >= settings.least_seen) return true;
    return grey_when_lit > 0 && looked.seen >= settings.least_of_small && looked.seen == looked.expected &&
           looked.most_off_mm <= settings.small_off_mm;
}

}  // namespace

double light_grey(const LightCheck& check) {
    return seen_of_first(check, std::numeric_limits<int>::max()).grey;
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

DarknessCheck::DarknessCheck(LightPutOut light, const SkinSurface& skin, const RigCalibration& rig,
                             const CheckLightSettings& look, const DarknessSettings& settings)
    : light_(std::move(light)),
      skin_(skin),
      rig_(rig),
      stands_at_(light_.rig_from_ct),
      look_(look),
      settings_(settings) {
    look_.far_too = false;
}

void DarknessCheck::stand_at(const RigidTransform& rig_from_ct) {
    if (checker_ && moved_mm(light_.drawing, stands_at_, rig_from_ct) < settings_.moved_mm) return;
    stands_at_ = rig_from_ct;
    const bool moved = moved_mm(light_.drawing, light_.rig_from_ct, rig_from_ct) >= settings_.moved_mm;
    PlanDrawing all = moved
                          ? light_on_moved_head(light_.drawing, skin_, rig_.projector, light_.rig_from_ct, rig_from_ct)
                          : light_.drawing;
    add_behind(all, light_.lit_now);
    checker_.emplace(all, skin_, rig_, look_, light_.bright_item);
}

bool DarknessCheck::look(const StereoFrame& frame, const std::optional<RigidTransform>& rig_from_ct) {
    stand_at(rig_from_ct.value_or(light_.rig_from_ct));
    const SeenLight looked = seen_of_first(checker_->look(stands_at_, frame), light_.drawing.items.size());
    const bool seen = is_the_light(looked, light_.grey, settings_);
    seen_running_ = seen ? seen_running_ + 1 : 0;
    if (seen)
        unseen_running_ = 0;
    else if (looked.expected >= settings_.least_of_small)  // else it could not have been seen
        ++unseen_running_;
    return lit();
}

}  // namespace planlight
