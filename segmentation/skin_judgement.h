#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"
#include "segmentation/segment_skin.h"
#include "segmentation/skin_shape.h"

namespace planlight {

/// A finding that a person must hear, with its figure and what to do.
struct SkinDoubt {
    std::string finding;      ///< one sentence
    std::string remedy;       ///< one sentence in the imperative
    bool of_the_end = false;  ///< only that the volume ends there: the skin that it shows is not doubted
};

/// Whether a skin is that of a head, and how it was asked. Lengths mm; a figure that could not be taken is not a
/// number.
struct SkinJudgement {
    std::vector<CutSide> cut_sides;
    double ball_radius_mm =
        0;  ///< of the largest ball within the upper head: an adult's skull 65 to 80, a newborn's 45
    Eigen::Vector3d ball_centre_in_ct = Eigen::Vector3d::Zero();
    double layered_share = 0;    ///< of the vault, where bone lies under the skin, between scalp and brain
    double scalp_mm = 0;         ///< median soft tissue over the bone of the vault
    double nose_mm = 0;          ///< how far the nose stands out before the cheeks
    double edge_blur_mm = 0;     ///< median way from 20 to 80 % of the step from air to skin
    double gap_cm2 = 0;          ///< of skin under which air is again (a mask, a cushion, a cloth)
    double boneless_cm2 = 0;     ///< patch of the upper head with no bone within 16 mm (a shining cushion)
    double light_cm2 = 0;        ///< of a volume in HU: what lies just under the surface is lighter than fat (hair)
    std::string light_at;        ///< where most of it is, in words
    double one_sided_cm2 = NAN;  ///< `ThingsOnSkin`, and the next three
    double bumps_cm2 = NAN;
    double width = NAN;
    double shelf_cm2 = NAN;
    double strand_mm = 0;  ///< of an MR: how long a thin thing is that hangs on the head
    double beside_mm = 0;  ///< `ball_beside_head_mm`
    bool unsure = false;   ///< much of the outline moves with the threshold: other thresholds are to be seen
    double sigma_mm = 0;   ///< `skin_edge_sigma_mm`, or more where the edge is blurred, with what fat may shift it
    double breadth_of_length = 0, height_of_width = 0;  ///< `head_proportions`; 0: not measured
    double slice_jump_mm = 0;  ///< of the outline between two slices, where the patient moved; else 0
    double echo = 0;           ///< `SeriesEcho::strength`, of an MR; 0: not asked
    double cut_air_share = 0, cut_body_share = 0;  ///< `CutGreys`; 0: nothing is cut
    double noise_sigma_mm = 0;                     ///< `skin_edge_sigma_mm` alone
    double fat_shift_mm = 0;                       ///< length of `Volume::fat_shift_in_ct`; 0: not said, or suppressed
    std::string fat_shift_along;                   ///< in words
    bool bright_bone = false;                      ///< bone shines like a CT's in a volume that is not in HU
    std::vector<SkinDoubt> doubts;                 ///< accepted with these
    std::vector<SkinDoubt> refusals;
};

/// Asks a skin whether it is that of a head: size (the largest ball in it), layers (scalp over bone over brain: a
/// stripped brain, a bottle and a phantom have none), face (a nose), ends, sharpness, symmetry, things that lie on it.
/// No name and no word of a header is asked.
SkinJudgement judge_skin(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin);

/// Throws InputError with the first refusal, if there is one.
void refuse_implausible(const SkinJudgement& judgement);

}  // namespace planlight
