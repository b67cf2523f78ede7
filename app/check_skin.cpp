// The session's short scan: does the skin still lie where the markers put it?
#include <algorithm>
#include <cmath>

#include "app/compare_skin.h"
#include "app/session.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "projection/light_gate.h"
#include "registration/matching/refine_pose_deformable.h"
#include "registration/matching/skin_again.h"

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
    compare_skin(skin.clean.kept, *registration_, *before.rig_from_patient * registration_->patient_from_ct, check);
    return check;
}

/// As the match itself was refined, so that what both get wrong alike cancels. A pose that is far off is no start for
/// that: what is found then is some place near by, with a wide bound, and the skin lies off all over.
void compare_skin(const PointCloud& cloud, const Case& the_case, const RegistrationResult& match,
                  const RigidTransform& rig_from_ct, double max_more_residual_mm, SkinCheck& check) {
    constexpr std::size_t kLeast = 1000, kLeastAmongCloth = 500;
    const double stop_mm = LightGateSettings{}.stop_mm;
    const bool among_cloth = match.skin_fraction.has_value();
    const SkinAgain again = skin_again(cloud, the_case.lut, rig_from_ct.inverse(),
                                       among_cloth ? match.skin : SkinDisplacement{}, match.skin_offset_mm.value_or(0));
    const PointCloud& skin = among_cloth ? again.cloud : cloud;
    check.points = skin.size();
    check.on_skin = again.cloud.size();
    check.residual_mm = again.median_mm;
    check.why_not = "too little skin was seen";
    if (check.points < (among_cloth ? kLeastAmongCloth : kLeast)) return;
    const DeformablePose found = refine_pose_deformable(skin, the_case.lut, rig_from_ct.inverse());
    const RigidTransform seen = found.ct_from_rig.inverse();
    for (const Eigen::Vector3d& p : points_of(the_case.plan)) {
        const double off_mm = (seen * p - rig_from_ct * p).norm();
        if (off_mm < check.off_mm) continue;
        check.off_mm = off_mm;
        check.bound_mm = predicted_error(found.covariance, p).bound_95_mm;
    }
    const bool far = match.skin.known() && check.on_skin >= kLeastAmongCloth &&
                     check.residual_mm > match.residual_median_mm + max_more_residual_mm;
    const bool tells = check.bound_mm <= stop_mm || check.bound_mm < check.off_mm;
    check.elsewhere = check.off_mm > stop_mm ? !tells : far;
    check.known = tells && !check.elsewhere;
    if (check.known) check.why_not.clear();
    if (check.elsewhere) check.why_not = "the skin does not lie where the markers put it";
    if (!check.known) check.off_mm = 0;
}

void Session::compare_skin(const PointCloud& cloud, const RegistrationResult& found, const RigidTransform& rig_from_ct,
                           SkinCheck& check) const {
    planlight::compare_skin(cloud, case_, found, rig_from_ct, settings_.resume.max_more_residual_mm, check);
}

}  // namespace planlight
