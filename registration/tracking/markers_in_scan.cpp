#include "registration/tracking/markers_in_scan.h"

#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"
#include "registration/scan/movement/uniform_light_frames.h"

namespace planlight {
namespace {

struct Look {
    std::string name;
    double when = 0;  ///< as a share of the scan
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
        if (pose.rig_from_patient) looks.push_back({moment.name, moment.when, *pose.rig_from_patient});
    }
    return looks;
}

constexpr std::size_t kFewMoments = 5;

using Places = std::vector<Eigen::Vector3d>;  ///< of one marker, by moments

Places places_of(const PatientMarker& marker, const std::vector<Look>& looks) {
    Places places;
    for (const Look& look : looks) places.push_back(look.rig_from_patient * marker.centre_in_patient);
    return places;
}

/// Where both neighbours say otherwise the middle one of the three counts: a pattern as fine as a marker's rim shifts
/// it in that moment alone, a patient who moves stays elsewhere. The first and the last stay as they are.
Places without_single_ones(const Places& places) {
    if (places.size() < kFewMoments) return places;
    Places kept = places;
    for (std::size_t i = 1; i + 1 < places.size(); ++i) {
        const Eigen::Array3d a = places[i - 1], b = places[i], c = places[i + 1];
        kept[i] = a.min(b).max(a.max(b).min(c));
    }
    return kept;
}

/// How far a marker is seen from where it is, between two moments (median): by second differences, which a way that
/// goes on evenly leaves out. At most `kMost_mm`, so that a head that trembles is not taken for scatter; 0 with few
/// moments.
double scatter_mm(const std::vector<Places>& markers) {
    constexpr double kMost_mm = 0.08;
    std::vector<double> bends;
    for (const Places& at : markers)
        for (std::size_t i = 1; at.size() >= kFewMoments && i + 1 < at.size(); ++i)
            bends.push_back((at[i - 1] - 2 * at[i] + at[i + 1]).norm() / std::sqrt(3.0));
    return std::min(kMost_mm, median(std::move(bends)));
}

}  // namespace

ScanMovement movement_of_markers(const ScanCapture& capture, const RigCalibration& rig,
                                 const TrackingSettings& settings) {
    ScanMovement movement;
    if (capture.right.empty() || !present(rig.right_camera)) return movement;
    TrackingSettings in_half_light = settings;  // else markers that are followed under white are not seen here
    in_half_light.markers.min_contrast /= 2;
    PatientTracker tracker(rig, in_half_light);
    const std::vector<Look> looks = looks_of(capture, tracker);
    movement.moments = static_cast<int>(looks.size());
    movement.markers = static_cast<int>(tracker.markers().size());
    if (looks.size() < 2) return movement;
    movement.by = ScanMovement::By::markers;
    movement.throughout = 2 * looks.size() >= uniform_light_frames(capture).size() && looks.front().when < 1.0 / 3 &&
                          looks.back().when > 2.0 / 3;
    std::vector<Places> markers;
    for (const PatientMarker& marker : tracker.markers()) markers.push_back(places_of(marker, looks));
    // Of a head that lies still, too, the greatest of a hundred pairs is twice what is usual and more.
    const double of_scatter_mm = 2 * scatter_mm(markers);
    for (Places& at : markers) at = without_single_ones(at);
    for (std::size_t i = 0; i < looks.size(); ++i)
        for (std::size_t j = i + 1; j < looks.size(); ++j)
            for (const Places& at : markers) {
                const double moved_mm =
                    std::sqrt(std::max(0.0, (at[j] - at[i]).squaredNorm() - of_scatter_mm * of_scatter_mm));
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
    ScanMovement movement = movement_of_markers(capture, rig, settings);
    if (movement.throughout) return movement;
    ScanMovement of_skin =
        movement_in_pictures(capture, mm_per_pixel(cloud, rig.left_camera), mm_per_pixel(cloud, rig.right_camera));
    return movement.way_mm() > of_skin.way_mm() ? movement : of_skin;
}

}  // namespace planlight
