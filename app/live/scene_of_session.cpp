#include "app/live/scene_of_session.h"

#include "app/windows/orientation.h"

namespace planlight {

std::shared_ptr<const std::vector<SceneMarker>> markers_in_ct(const PatientTracker& tracker,
                                                              const RigidTransform& ct_from_patient) {
    auto markers = std::make_shared<std::vector<SceneMarker>>();
    for (const auto& marker : tracker.markers()) {
        SceneMarker shown;
        shown.p_in_ct = ct_from_patient * marker.centre_in_patient;
        markers->push_back(shown);
    }
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
    const auto& whole = overlay.counts.labels_lit;
    for (const Label& label : drawing.labels) {
        if (label.of_moment || std::find(whole.begin(), whole.end(), label.item) == whole.end()) continue;
        for (const auto& sign : label.signs_in_ct)
            for (const auto& outline : sign) add(outline, true);
    }
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
