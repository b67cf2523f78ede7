#include "registration/tracking/markers_in_scan.h"

#include "registration/scan/movement/uniform_light_frames.h"

namespace planlight {
namespace {

struct Look {
    std::string name;
    RigidTransform rig_from_patient;
};

std::vector<Look> looks_of(const ScanCapture& capture, PatientTracker& tracker) {
    std::vector<Look> looks;
    const double lasted_s = seconds(capture.ended - capture.began);
    for (const UniformLightFrame& moment : uniform_light_frames(capture)) {
        StereoFrame frame;
        frame.left = half_uniform_light(capture.left, moment);
        frame.right = half_uniform_light(capture.right, moment);
        frame.at = capture.began + from_seconds(moment.when * lasted_s);
        if (looks.empty() && tracker.markers().empty()) tracker.set_reference(frame);
        const TrackedPose pose = tracker.update(frame);
        if (pose.rig_from_patient) looks.push_back({moment.name, *pose.rig_from_patient});
    }
    return looks;
}

}  // namespace

ScanMovement movement_of_markers(const ScanCapture& capture, const RigCalibration& rig,
                                 const TrackingSettings& settings) {
    ScanMovement movement;
    if (capture.right.empty() || !present(rig.right_camera)) return movement;
    PatientTracker tracker(rig, settings);
    const std::vector<Look> looks = looks_of(capture, tracker);
    movement.moments = static_cast<int>(looks.size());
    movement.markers = static_cast<int>(tracker.markers().size());
    if (looks.size() < 2) return movement;
    movement.by = ScanMovement::By::markers;
    for (std::size_t i = 0; i < looks.size(); ++i)
        for (std::size_t j = i + 1; j < looks.size(); ++j)
            for (const PatientMarker& marker : tracker.markers()) {
                const Eigen::Vector3d& p = marker.centre_in_patient;
                const double moved_mm = (looks[j].rig_from_patient * p - looks[i].rig_from_patient * p).norm();
                if (moved_mm <= movement.moved_mm) continue;
                movement.moved_mm = moved_mm;
                movement.turned = angle_between(looks[j].rig_from_patient, looks[i].rig_from_patient);
                movement.from = looks[i].name;
                movement.to = looks[j].name;
            }
    return movement;
}

ScanMovement movement_in_scan(const ScanCapture& capture, const RigCalibration& rig, const PointCloud& cloud,
                              const TrackingSettings& settings) {
    const ScanMovement movement = movement_of_markers(capture, rig, settings);
    if (movement.by == ScanMovement::By::markers) return movement;
    return movement_in_pictures(capture, mm_per_pixel(cloud, rig.left_camera), mm_per_pixel(cloud, rig.right_camera));
}

}  // namespace planlight
