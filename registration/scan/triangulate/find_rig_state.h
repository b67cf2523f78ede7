#pragma once

#include "planning_io/types/rig_state.h"
#include "registration/scan/triangulate/match_views.h"

namespace planlight {

/// What a good calibration leaves wrong in a device, one standard deviation. What the lens's numbers get wrong the pose
/// makes up for at the working distance, as it does in a calibration that fits its pictures; a little of it stays.
struct CalibrationPrior {
    double usual_rms_px =
        0.12;  ///< these numbers are of a rig with this `reprojection_rms_px`; a worse one has them in proportion
    double at_most = 4;       ///< times
    double focal = 2.6e-4;    ///< relative, made up for by depth
    double centre_px = 0.2;   ///< made up for by a turn
    double corner_px = 0.07;  ///< of distortion, in the corner of the picture
    double left_px = 0.055;   ///< that nothing makes up for: of turn and shift
    double roll = 1.2e-4;     ///< radians
    double depth_mm = 0.07;
    double projector = 2;  ///< so much worse is the projector known
};

/// What counts as moved, and what is no bump any more.
struct RigStateSettings {
    CalibrationPrior calibration;
    std::size_t places = 600;  ///< of the skin, looked at
    std::size_t min_places = 200;
    double independent = 60;                   ///< so many places' worth the whole surface is (see `rig_residuals`)
    double moved_turn = 0.0105, moved_mm = 3;  ///< what a moved device may have done, sigma: 0.6 degrees
    double lens_focal = 0.03, lens_centre = 0.01, lens_k1 = 0.05;  ///< a lens that was touched; centre by the width
    /// How much better (chi-square) another rig must explain the scan before rig.json is not taken as it is, and how
    /// much worse than the best one may explain it and still be the true one.
    double moved_chi_square = 25, doubt_chi_square = 16;
    double lens_and_place_penalty = 12, two_devices_penalty = 20;  ///< of explanations with more to choose
    /// Both cameras' focal lengths changed alike: as warmth does it, or a person who focuses both; no zoom is turned by
    /// the same on both.
    double both_lenses_focal = 0.003, both_lenses_penalty = 6;
    double max_usual_residual = 4;  ///< sigmas; more is a rig that fits from no place
    /// How far the cameras' rays may miss each other by rig.json, sigmas of a pixel (usual place), before the rig is
    /// adjusted within what its calibration leaves open; the points of farther places are lost.
    double max_unadjusted = 1.5;
    double max_hidden_mm = 0.5;  ///< light that may be off without a sign of it; above: not trusted
};

/// The joint adjustment of all three devices over one scan: the cameras against each other (epipolar lines), the code
/// of both against the projector, and the calibration's own uncertainty as prior. First as calibrated; where that does
/// not hold, every device (or two of them) is taken to have moved, or its lens to have been touched, and the
/// explanation that costs least is taken; those that cost little more are kept as doubts, with what they would do to
/// the light. A rig that holds, but only within what its calibration leaves open, is adjusted by that much
/// (`max_unadjusted`). The scale of the whole is never seen, nor a camera that moved along the line to the other.
///
/// The verdict is `unknown` where too few places are seen by both cameras. `capture_hash` and `calibrated` are the
/// caller's to fill. MacKay 2003, ch. 28, for comparing explanations; Hartley & Zisserman, 18, for the adjustment.
RigState find_rig_state(const ViewMatches& matches, const RigCalibration& rig, const RigStateSettings& settings = {});

}  // namespace planlight
