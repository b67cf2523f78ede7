// A kept match taken up again: light only when markers, rig and skin still agree with it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/belonging.h"
#include "app/compare_skin.h"
#include "app/session.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr const char* kScanAgain = "Scan the patient again.";

[[noreturn]] void refuse(const std::string& why, const std::string& remedy = kScanAgain) {
    throw CheckFailedError("the last match is not used: " + why, remedy);
}

/// Columns and rows, so that the projector's place is seen as well, in about half a scan's pictures.
StripeSettings resume_stripes(int width, int height) {
    StripeSettings stripes = fast_stripes(width, height);
    stripes.rows = true;
    return stripes;
}

void check_belongs(const KeptMatch& match, const Case& the_case, const RigCalibration& calibrated) {
    const RegistrationResult& found = match.registration;
    if (found.verdict == Verdict::no || !found.rig || !found.rig->rig.whole())
        refuse("it holds no match of a whole rig");
    if (found.of_case != name_of(the_case))
        refuse(fmt::format("it is of the case {}, and this is the case {}", found.of_case.code, name_of(the_case).code),
               "Open the case that was matched, or scan the patient.");
    if (match.plan_hash != the_case.plan_hash) refuse("the plan of this case is another than the one that was drawn");
    if (found.rig->calibrated.hash != hash_of(calibrated))
        refuse(fmt::format("it was made with another rig (calibrated {}, this one {})",
                           found.rig->calibrated.made_on.empty() ? "on a day not said" : found.rig->calibrated.made_on,
                           calibrated.made_on.empty() ? "on a day not said" : calibrated.made_on));
}

/// Each of the match's markers against a disc of now; what is far from all others is another disc.
void compare_markers(const std::vector<PatientMarker>& kept, const std::vector<PatientMarker>& now,
                     const RigidTransform& rig_from_patient, double same_mm, const ResumeSettings& settings,
                     ResumeCheck& check) {
    std::size_t strangers = 0;
    for (const PatientMarker& disc : now) {
        double nearest_mm = same_mm, sigma_mm = 0;
        for (const PatientMarker& marker : kept) {
            const double mm = (rig_from_patient * marker.centre_in_patient - disc.centre_in_patient).norm();
            if (mm >= nearest_mm) continue;
            nearest_mm = mm;
            sigma_mm = std::hypot(marker.sigma_mm, disc.sigma_mm);
        }
        if (nearest_mm >= same_mm) {
            ++strangers;
            continue;
        }
        ++check.markers;
        check.marker_off_mm = std::max(check.marker_off_mm, nearest_mm);
        if (nearest_mm > std::max(settings.max_marker_off_mm, 4 * sigma_mm))
            refuse(fmt::format("a marker has moved, or a camera: it lies {:.1f} mm from where the others put it",
                               nearest_mm));
    }
    if (strangers > 0 && check.markers < static_cast<int>(kept.size()))
        refuse("a marker was moved: a disc lies where none was, and one is missing where it was");
}

/// How far light of the plan's points falls from where it fell, by two places of the projector, mm.
double light_moved_mm(const CameraModel& was, const CameraModel& now, const RigidTransform& rig_from_ct,
                      const Plan& plan) {
    double most_mm = 0;
    for (const Eigen::Vector3d& p_in_ct : points_of(plan)) {
        const Eigen::Vector3d p = rig_from_ct * p_in_ct;
        const auto before = project(was, p), after = project(now, p);
        if (!before || !after) continue;
        most_mm = std::max(most_mm, (*before - *after).norm() * (was.device_from_rig * p).z() / was.focal_x);
    }
    return most_mm;
}

}  // namespace

std::optional<KeptMatch> Session::kept_match() const {
    if (!registration_ || registration_->verdict == Verdict::no || !registration_->rig) return std::nullopt;
    return KeptMatch{*registration_, tracker_.markers(), case_.plan_hash, confirmed_, {}, lit_part()};
}

ResumeCheck Session::take_up(const KeptMatch& match, const std::function<void(int, int)>& progress) {
    darken();
    registration_.reset(), scanned_.reset(), capture_.reset(), rig_state_.reset();
    landmarks_.reset(), lit_landmark_.reset();
    confirmed_ = false;
    found_delay_ = {};
    check_belongs(match, case_, calibrated_);
    RigCalibration rig = match.registration.rig->rig;
    rig.reprojection_rms_px = calibrated_.reprojection_rms_px;
    rig.made_on = calibrated_.made_on;
    use_rig(rig);
    tracker_.set_reference(match.markers);
    ++references_;
    light_part(match.lit);
    ResumeCheck check;
    const RigidTransform rig_from_patient = compare_room(match, progress, check);
    compare_skin_again(match, rig_from_patient, check);
    forget_last_light();  // stripes took its place
    registration_ = match.registration;
    rig_state_ = registration_->rig;
    confirmed_ = match.confirmed;
    motion_in_scan_mm_ = registration_->moved_in_scan_mm.value_or(0);
    draw_on_skin_as_found();
    start_overlay();
    return check;
}

/// Markers and rig; the pose at the short scan, T_cur.
RigidTransform Session::compare_room(const KeptMatch& match, const std::function<void(int, int)>& progress,
                                     ResumeCheck& check) {
    const ResumeSettings& limits = settings_.resume;
    const ScanCapture capture =
        capture_scan(projector_, cameras_, clock_, resume_stripes(projector_.width(), projector_.height()), progress);
    const StereoFrame white{capture.left.front(), capture.right.front(), capture.began, Instant{}, 0};
    const TrackedPose before = tracker_.update(white);
    const std::vector<MarkerDoubt> doubts = tracker_.doubts();
    if (!before.rig_from_patient)
        refuse("the markers are not as they were: " + before.reason, "Free the markers and try again, or scan again.");
    if (!doubts.empty())
        refuse(fmt::format("a marker has moved {:.1f} mm against the others", doubts.front().deviation_mm));
    PatientTracker alone(rig_, settings_.tracking);
    compare_markers(match.markers, alone.set_reference(white), *before.rig_from_patient,
                    settings_.tracking.design.disc_diameter_mm, limits, check);
    const int least = std::min(settings_.min_reference_markers, static_cast<int>(match.markers.size()));
    if (check.markers < least)
        refuse(fmt::format("only {} of its {} markers are seen by both cameras", check.markers, match.markers.size()),
               "Free the markers and try again, or scan again.");
    const TrackedPose after = pose_under_white();
    if (!after.rig_from_patient) refuse("the markers were lost meanwhile: " + after.reason);
    for (const auto& marker : match.markers)
        check.moved_meanwhile_mm = std::max(
            check.moved_meanwhile_mm,
            (*before.rig_from_patient * marker.centre_in_patient - *after.rig_from_patient * marker.centre_in_patient)
                .norm());
    if (check.moved_meanwhile_mm > limits.max_motion_mm)
        refuse("the patient moved meanwhile", "Have the patient lie still and try again, or scan again.");
    ScanSettings scan = settings_.scan;
    scan.use_resection = false;  // the cloud as the match's own rig sees it
    ScanResult result = scan_from_capture(capture, rig_, scan);
    check.rig = result.rig;
    if (result.resection && result.resection->rms_after_px <= scan.resection.max_rms_after_px)
        check.light_moved_mm =
            light_moved_mm(rig_.projector, result.resection->projector,
                           *before.rig_from_patient * match.registration.patient_from_ct, case_.plan);
    check.cloud = std::make_shared<const PointCloud>(std::move(result.clean.kept));
    check.points = check.cloud->size();
    if (check.rig.moved()) refuse("the rig has moved since: " + check.rig.sentence);
    if (check.rig.verdict == RigState::Verdict::unknown) refuse(check.rig.sentence);
    if (check.light_moved_mm > limits.max_light_moved_mm)
        refuse(fmt::format("the projector has moved since: its light would fall {:.1f} mm beside the plan",
                           check.light_moved_mm));
    return *before.rig_from_patient;
}

void Session::compare_skin_again(const KeptMatch& match, const RigidTransform& rig_from_patient,
                                 ResumeCheck& check) const {
    const ResumeSettings& limits = settings_.resume;
    const RegistrationResult& found = match.registration;
    const RigidTransform rig_from_ct = rig_from_patient * found.patient_from_ct;
    SkinCheck skin;
    compare_skin(*check.cloud, case_, found, rig_from_ct, limits.max_more_residual_mm, skin);
    check.residual_mm = skin.residual_mm;
    check.skin_off_mm = skin.off_mm, check.bound_mm = skin.bound_mm;
    // Where cloth was left out at the match it may be most of this scan as well.
    if (!found.skin_fraction && 2 * skin.on_skin < check.cloud->size())
        refuse("the skin does not lie where the markers put it");
    if (check.residual_mm > found.residual_median_mm + limits.max_more_residual_mm)
        refuse(
            fmt::format("the skin is not where the markers put it: it lies {:.1f} mm off, and {:.1f} mm at the match",
                        check.residual_mm, found.residual_median_mm));
    if (!skin.known) refuse(skin.why_not);
    if (check.skin_off_mm > limits.max_skin_off_mm)
        refuse(
            fmt::format("the head has moved against its markers: the plan's skin lies {:.1f} mm off where they put it",
                        check.skin_off_mm));
}

}  // namespace planlight
