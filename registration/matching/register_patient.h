#pragma once

#include <optional>

#include "planning_io/types/registration_result.h"
#include "registration/matching/find_skin.h"
#include "registration/matching/initial_match.h"
#include "registration/matching/refine_icp.h"
#include "registration/matching/refine_pose_deformable.h"

namespace planlight {

/// When the skin that was found among cloth may be used. Stricter than for a scan of skin alone: the part was chosen
/// because it fits.
struct AmongClothLimits {
    double bare_fraction = 0.85;                          ///< of the scan on the skin: there is no cloth to look for
    double max_inside = 0.03, far_too_much_inside = 0.1;  ///< of the scan, in the body; above: ask, no
    double far_too_little_skin = 0.03;                    ///< of the scan, on the skin; below: no
    /// What was chosen because it fits must fit closely: rms of the skin alone; above: ask, the lower one where much of
    /// it goes on smoothly, off the skin.
    double max_residual_rms_mm = 0.7, max_goes_on = 0.15, max_rms_goes_on_mm = 0.5;
    double min_rival_ratio = 1.3;                               ///< of what is explained, to the next pose; below: ask
    double min_runner_up_ratio = 1.3, min_mirror_ratio = 1.25;  ///< of the skin alone; below: ask
    double min_inlier_fraction = 0.85, far_too_few_inliers = 0.7;  ///< of the skin alone; below: ask, no
    double far_too_much_scale = 0.04;  ///< of the skin alone, and 2 of its sigmas; above: no
};

/// Of the whole match, and from when on it is not `yes`; the rules stand in VERDICT.md.
struct RegistrationSettings {
    InitialMatchSettings initial;
    IcpSettings icp;
    bool moved_skin = true;  ///< end the fine match with refine_pose_deformable; false: the ICP's pose as it is
    DeformableSettings skin;
    int min_points = 1000;
    double min_extent_mm = 60;          ///< second largest extent of the cloud
    double min_runner_up_ratio = 1.15;  ///< below: ask; below 1.05: no
    double inlier_distance_mm = 1.5;
    double min_inlier_fraction = 0.8;  ///< of what is no stray; below: ask; below 0.5: no
    double max_residual_rms_mm = 1.0;  ///< of the inliers; above: no
    /// Points anywhere within 1.5 mm have an rms of 0.87 mm: a fit as loose as that, of not nearly all, and not by the
    /// scan's noise alone: ask.
    double loose_residual_rms_mm = 0.75, loose_shape_rms_mm = 0.5, loose_inlier_fraction = 0.9;
    /// Skin of another shape than the CT's, at a place that is not well determined: cloth that follows the head, or
    /// skin that was pulled along. Both above: ask.
    double max_shape_rms_mm = 0.5, weak_sigma_mm = 0.65;
    int min_agreeing_bases = 2;
    double max_weakest_sigma_mm = 1.25;  ///< of the movement 80 mm from the scan's centre; above: ask
    double max_skin_offset_mm = 1.5;     ///< of the whole skin; above: ask
    /// Of the skin over the bone, rms: a broad swelling of one side is taken for a head that lies otherwise, in part.
    /// Above: ask.
    double max_skin_movement_mm = 0.5;
    /// Of the skin's places about its offset (`spread_of_skin_mm`). Skin that sagged is taken for a head that
    /// lies otherwise and little of it is left as movement; what the pose cannot follow still shows here. Above: ask.
    double max_skin_spread_mm = 0.25;
    /// What of that spread is more than still skin usually shows stands for a shift of the pose that nothing else
    /// shows: this many times as large, one standard deviation each way, in the predicted error.
    double still_skin_spread_mm = 0.15, shift_by_spread = 2;
    double max_shape_change_mm = 1.25;  ///< `SmoothDeformation`, times its probability; above: ask
    bool mirror_test = true;            ///< match the mirrored scan too
    double min_mirror_ratio = 1.15;     ///< of the mirrored scan's cost; below: ask
    double mirror_fits_better = 0.87;   ///< below: no
    /// Where the scan was lit or seen from (a device that all points were seen by), rig frame: then the way back from
    /// every point must be free in the CT too.
    std::optional<Eigen::Vector3d> viewpoint_in_rig;
    double max_blocked = 0.1, far_too_many_blocked = 0.3;  ///< share of the ways that are not; above: ask, no
    bool leave_cloth_out = true;  ///< that lies close on the skin (`innermost_layer`); false: all that was found
    /// Of the way that the pose went when cloth close on the skin was left out: what may be wrong with it, one sigma.
    double left_out_share = 0.35;
    bool look_among_cloth = true;  ///< where the whole scan is not sure and much of it lies off the skin
    FindSkinSettings find_skin;
    AmongClothLimits among_cloth;
    double far_too_much_scale = 0.06;  ///< of the scan against the CT, and 2 of its sigmas; above: no
    double max_scale_error = 0.015;    ///< of the scan against the CT, and 1.5 of its sigmas; above: ask
    double clear_scale_error = 0.008;  ///< the same, and 4 of its sigmas
};

/// Finds the patient without help: initial match, ICP, verdict with evidence. `patient` equals `rig` at the scan
/// instant, so the result is `patient_from_ct` = T_ini. Never throws for "not found": the verdict says so, with reasons
/// in words.
RegistrationResult register_patient(const PointCloud& cloud, const SkinLut& lut,
                                    const RegistrationSettings& settings = {});

/// The fine match alone, from a start within some 10 mm and 10 degrees, judged by all that does not need the search:
/// the verdict is at best `ask`, for nothing says that no other pose fits as well. No runner-up, bases or mirror in the
/// result; the first of its reasons says that it was helped.
RegistrationResult register_patient_near(const PointCloud& cloud, const SkinLut& lut,
                                         const RigidTransform& start_patient_from_ct,
                                         const RegistrationSettings& settings = {});

}  // namespace planlight
