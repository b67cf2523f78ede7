#pragma once

#include <optional>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// How the head that was scanned differs from the CT's by a smooth change of its whole shape.
struct SmoothDeformation {
    /// By how much the scan's places lie elsewhere than the pose puts them, if it is so: along the skin, too, where no
    /// residual shows it. Of 95 % of them at most, mm.
    double p95_mm = 0;
    /// Logarithm of how many times as likely the residuals are with a change of shape as without (Bayes factor); below
    /// 0 the head has the CT's shape.
    double log_evidence = 0;

    /// 0 to 1, where a change and none were as likely before.
    double probability() const;
};

/// Asks at the pose that the fine match found whether the scan is that of a head which is longer along an axis, sheared
/// or twisted about one (nine modes: symmetric strain and torsion, Bookstein 1989 calls the first six uniform): another
/// patient of like build, one who slowly turned during the CT, a gantry tilt that was lost. A twist about a head's long
/// axis moves skin along itself: the pose takes up its mean, the residuals stay small, and the light is off.
///
/// The modes have a Gaussian prior of one to ten times the skin's own movement, which is the field of
/// `refine_pose_deformable`; models with and without them are compared by their marginal likelihood and averaged (Kass
/// & Raftery 1995; Hoeting et al. 1999).
///
/// Empty where it cannot be told: the scan has too few patches of skin, or no model can be solved.
std::optional<SmoothDeformation> fit_smooth_deformation(const PointCloud& cloud, const SkinLut& lut,
                                                        const RigidTransform& ct_from_rig, int max_patches = 240);

}  // namespace planlight
