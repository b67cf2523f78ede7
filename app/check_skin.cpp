// The session's short scan: does the skin still lie where the markers put it?
#include <algorithm>
#include <cmath>

#include "app/compare_skin.h"
#include "app/session.h"
#include "planning_io/types/error.h"

namespace planlight {

SkinCheck Session::measure_skin(const std::function<void(int, int)>& progress) {
    if (!registration_ || registration_->verdict == Verdict::no)
        throw CheckFailedError("there is no match to compare the skin with", "Scan and register first.");
    overlay_.reset();
    projector_.go_dark();
    const ScanCapture capture =
        capture_scan(projector_, cameras_, clock_, fast_stripes(projector_.width(), projector_.height()), progress);
    const TrackedPose before =
        tracker_.update({capture.left.front(), capture.right.front(), capture.began, Instant{}, 0});
    const TrackedPose after = pose_under_white();
    SkinCheck check;
    if (!before.rig_from_patient || !after.rig_from_patient) {
        check.why_not = "the markers were not seen: " + (before.rig_from_patient ? after : before).reason;
        return check;
    }
    for (const auto& marker : tracker_.markers())
        check.moved_meanwhile_mm = std::max(
            check.moved_meanwhile_mm,
            (*before.rig_from_patient * marker.centre_in_patient - *after.rig_from_patient * marker.centre_in_patient)
                .norm());
    if (check.moved_meanwhile_mm > settings_.max_motion_in_skin_check_mm) {
        check.why_not = "the patient moved during the check";
        return check;
    }
    ScanSettings scan = settings_.scan;
    scan.use_resection = false;
    const ScanResult skin = scan_from_capture(capture, rig_, scan);
    if (!skin.clean.kept.empty()) forget_last_light();  // stripes took its place
    compare_skin(skin.clean.kept, case_, *registration_, *before.rig_from_patient * registration_->patient_from_ct,
                 settings_.resume.max_more_residual_mm, check);
    return check;
}

}  // namespace planlight
