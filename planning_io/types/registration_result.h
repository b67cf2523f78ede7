#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/pose_covariance.h"
#include "planning_io/types/rig_state.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_displacement.h"

namespace planlight {

/// Whether a match may be used.
enum class Verdict {
    yes,  ///< may be used
    ask,  ///< needs a person's look at the overlay on landmarks before it is used
    no,   ///< there is no pose
};

/// Which case something belongs to.
struct CaseName {
    std::string code, volume_hash, mesh_hash;  ///< as in case.json; empty: not known
    bool known() const { return !volume_hash.empty(); }
    bool operator==(const CaseName&) const = default;
};

/// Where the patient lies: the paper's T_ini, with what it was judged by.
struct RegistrationResult {
    Verdict verdict = Verdict::no;
    std::vector<std::string> reasons;  ///< in words, one sentence each, why it is not `yes`; empty when it is
    RigidTransform patient_from_ct = RigidTransform::Identity();  ///< T_ini; meaningless when the verdict is `no`

    double residual_rms_mm = 0;     ///< of the inliers, point to surface
    double residual_median_mm = 0;  ///< of all points, absolute
    double inlier_fraction = 0;     ///< of the points judged, nearer than `inlier_distance_mm` to the skin
    double inlier_distance_mm = 0;
    std::size_t points = 0;         ///< of the scan
    std::size_t judged_points = 0;  ///< of these, what was matched: strays left out, and cloth where skin was found
    std::optional<double>
        skin_fraction;           ///< of the scan, found as skin among cloth and matched alone; empty: not looked for
    double runner_up_ratio = 0;  ///< cost of the best distinct other pose / cost of this one; > 1 is good
    int agreeing_bases = 0;      ///< independent contact triplets that led to this pose
    std::optional<double> weakest_sigma_mm;  ///< how far the patient could slide along the least determined way
    double mirror_ratio = 0;  ///< cost of the mirrored scan's best pose / cost of this one; > 1 is good; 0: not tried
    std::optional<double>
        blocked_fraction;  ///< of the ways back to the viewpoint, through the body; empty: none was said
    std::optional<double> moved_in_scan_mm;  ///< the most that a marker moved during the scan; empty: not looked at
    std::optional<double> landmarks_off_mm;  ///< the farthest landmark from where T_ini puts it; empty: there were none
    double scale = 1;                        ///< by which the scan would have to grow to fit best; 1 is good
    double scale_sigma = 0;                  ///< one standard deviation of that
    PoseCovariance covariance;               ///< how uncertain T_ini is, for `predicted_error` at any point
    // Empty where it is not known: no scan was matched finely, or it has too little skin to tell.
    std::optional<double> skin_movement_mm;  ///< of the skin since the CT, rms, as the residuals tell it
    std::optional<double> skin_offset_mm;    ///< of the whole skin; positive outside of the CT's
    std::optional<double>
        shape_change_mm;  ///< how far light could be off because the head is smoothly deformed against the CT's
    double initial_match_s = 0, refine_s = 0;
    RigidTransform initial_patient_from_ct = RigidTransform::Identity();  ///< before the ICP (Fig. 3 left)
    SkinDisplacement skin;  ///< where the scan found the skin at this pose; not known where only landmarks were matched

    CaseName of_case;             ///< whose table was matched
    std::optional<RigState> rig;  ///< that the cloud was made with and the light is to be drawn with; empty: not known
};

}  // namespace planlight
