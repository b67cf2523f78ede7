#include "app/compare_skin.h"

#include <cmath>

#include "planning_io/plan/plan_file.h"
#include "projection/light_gate.h"
#include "registration/matching/refine_pose_deformable.h"
#include "registration/matching/skin_again.h"

namespace planlight {

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
        if (off_mm < check.off_mm || std::isnan(check.off_mm)) continue;
        check.off_mm = off_mm;
        check.bound_mm = predicted_error(found.covariance, p).bound_95_mm;
    }
    const bool far = match.skin.known() && check.on_skin >= kLeastAmongCloth &&
                     check.residual_mm > match.residual_median_mm + max_more_residual_mm;
    const bool tells = check.bound_mm <= stop_mm || check.bound_mm < check.off_mm;
    // What was laid on the skin since the match, drapes say, does not make the skin lie elsewhere: it lies outside of
    // it only, and leaves a part of it as it was.
    constexpr double kLeftFree = 0.25, kNoneInside = 0.03;
    const bool laid_on = far && !among_cloth && again.near_share >= kLeftFree && again.inside_share <= kNoneInside;
    check.elsewhere = !laid_on && (check.off_mm > stop_mm ? !tells : far);
    check.known = tells && !check.elsewhere && !laid_on && std::isfinite(check.off_mm);
    if (check.known) check.why_not.clear();
    if (laid_on) check.why_not = "cloth or something else lies on the skin that the match was made on";
    if (check.elsewhere) check.why_not = "the skin does not lie where the markers put it";
    if (!check.known) check.off_mm = 0;
}

}  // namespace planlight
