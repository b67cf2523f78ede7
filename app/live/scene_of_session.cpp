#include "app/live/scene_of_session.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/windows/orientation.h"

namespace planlight {

SceneMarker marker_on_skin(const Eigen::Vector3d& p_in_ct, const SkinSurface& skin) {
    constexpr int kWays = 12;
    const SkinSurface::Point foot = skin.nearest(p_in_ct);
    SceneMarker marker;
    marker.normal_in_ct = skin.mean_normal(foot, kStickerRadius_mm);
    const Eigen::Vector3d u = marker.normal_in_ct.unitOrthogonal(), v = marker.normal_in_ct.cross(u);
    double above_mm = marker.normal_in_ct.dot(p_in_ct - foot.p_in_ct);
    for (const double radius_mm : {0.0, kStickerRadius_mm / 2, kStickerRadius_mm})
        for (int k = 0; k < kWays; ++k) {
            const double angle = 2 * std::numbers::pi * k / kWays;
            const Eigen::Vector3d over = foot.p_in_ct + kStickerRadius_mm * marker.normal_in_ct +
                                         radius_mm * (std::cos(angle) * u + std::sin(angle) * v);
            if (const auto under = skin.first_hit({over, -marker.normal_in_ct}))
                above_mm = std::max(above_mm, marker.normal_in_ct.dot(under->p_in_ct - foot.p_in_ct));
        }
    marker.p_in_ct = foot.p_in_ct + above_mm * marker.normal_in_ct;
    return marker;
}

std::shared_ptr<const std::vector<SceneMarker>> markers_in_ct(const PatientTracker& tracker,
                                                              const RigidTransform& ct_from_patient,
                                                              const SkinSurface& skin) {
    auto markers = std::make_shared<std::vector<SceneMarker>>();
    for (const auto& marker : tracker.markers())
        markers->push_back(marker_on_skin(ct_from_patient * marker.centre_in_patient, skin));
    return markers;
}

std::shared_ptr<const std::vector<LightLine>> true_light_lines(const PlanDrawing& drawing,
                                                               const RigCalibration& calibration,
                                                               const OverlayStep& overlay,
                                                               const simulation::SimulatedRig& rig) {
    auto lines = std::make_shared<std::vector<LightLine>>();
    if (!overlay.lit) return lines;
    const auto add = [&](const std::vector<Eigen::Vector3d>& wanted_in_ct, bool closed) {
        LightLine line;
        line.closed = closed;
        for (const auto& p_in_ct : wanted_in_ct) {
            const auto pixel = project(calibration.projector, overlay.rig_from_ct * p_in_ct);
            const auto lit = pixel ? rig.true_light(*pixel, overlay.lit_from) : std::nullopt;
            if (lit) line.points_in_ct.push_back(lit->p_in_ct);
        }
        if (line.points_in_ct.size() > 1) lines->push_back(std::move(line));
    };
    for (const auto& stroke : drawing.strokes) add(stroke.points_in_ct, stroke.closed);
    return lines;
}

SceneView projector_view(const RigCalibration& rig, const RigidTransform& ct_from_rig) {
    const Eigen::Matrix3d ct_from_projector = ct_from_rig.linear() * rig.projector.device_from_rig.linear().transpose();
    return view_along(-ct_from_projector.col(2), -ct_from_projector.col(1));  // z forward, y down
}

std::vector<FoundMarker> found_markers(const std::vector<PatientTracker::Seen>& seen, bool all) {
    std::vector<FoundMarker> found;
    for (const auto& one : seen)
        if (all || one.marker >= 0)
            found.push_back({one.left_or_right.pixel, one.left_or_right.radius_px,
                             one.marker >= 0 ? FoundMarker::Pairing::both : FoundMarker::Pairing::alone});
    return found;
}

void show_refused_scan(const Session& session, OperatorModel& model) {
    if (session.capture() == nullptr || session.capture()->left.empty()) return;
    const ScanCapture& capture = *session.capture();
    model.left.refused = SeenPicture{std::make_shared<GrayImage>(capture.left.front()),
                                     found_markers(session.tracker().seen_left(), true), true};
    model.right.refused = SeenPicture{std::make_shared<GrayImage>(capture.right.front()),
                                      found_markers(session.tracker().seen_right(), true), true};
}

}  // namespace planlight
