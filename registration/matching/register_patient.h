#pragma once

#include <optional>

#include "planning_io/types/registration_result.h"
#include "registration/matching/initial_match.h"
#include "registration/matching/refine_icp.h"
#include "registration/matching/refine_pose_deformable.h"

namespace planlight {

struct RegistrationSettings {
    InitialMatchSettings initial;
    IcpSettings icp;
    bool moved_skin = true;  ///< end the fine match with refine_pose_deformable; false: the ICP's pose as it is
    DeformableSettings skin;
    int min_points = 1000;
    double min_extent_mm = 60;          ///< second largest extent of the cloud
    double min_runner_up_ratio = 1.15;  ///< below: ask; below 1.05: no
    double inlier_distance_mm = 1.5;
    double min_inlier_fraction = 0.7;  ///< below: ask; below 0.5: no
    double max_residual_rms_mm = 1.0;  ///< of the inliers; above: no
    int min_agreeing_bases = 2;
    double max_weakest_sigma_mm = 1;   ///< above: ask
    double max_skin_offset_mm = 1.5;   ///< of the whole skin; above: ask
    bool mirror_test = true;           ///< match the mirrored scan too
    double min_mirror_ratio = 1.15;    ///< of the mirrored scan's cost; below: ask
    double mirror_fits_better = 0.87;  ///< below: no
    /// Where the scan was lit or seen from (a device that all points were seen by), rig frame: then the way back from
    /// every point must be free in the CT too.
    std::optional<Eigen::Vector3d> viewpoint_in_rig;
    double max_blocked = 0.1, far_too_many_blocked = 0.3;  ///< share of the ways that are not; above: ask, no
    double max_scale_error = 0.015;  ///< of the scan against the CT, and 1.5 of its sigmas; above: ask
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
