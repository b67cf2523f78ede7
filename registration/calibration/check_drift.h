#pragma once

#include <string>
#include <vector>

#include "registration/calibration/bent_residuals.h"
#include "registration/scan/scan_surface.h"

namespace planlight {

/// What a scan may show of a rig's age. The noise of a good rig is about a quarter of the limits.
struct DriftLimits {
    /// Distance of corresponding points from their epipolar line: over four sigmas of what the error of a good
    /// calibration makes of it (0.09 px in the paper's rig, 0.10 px in a modern one: `EpipolarLimit` in the tests).
    double epipolar_px = 0.4;
    double projector_px =
        0.8;  ///< rms length between the decoded projector pixel and the rig's: a third of a mm on the patient
    double projector_after_px = 0.5;  ///< the same once the projector is placed anew: more is another lens setting
    std::size_t min_points = 500;     ///< seen by both cameras under the light
    double code_step_px = 2;          ///< projector pixels to which the light must be read (ScanResult::code_step_px)
    /// A bend (see BentResiduals) beyond what good rigs show: in 40 simulated rooms at most 0.09, 3.1 sigma and 0.053
    /// px.
    double camera_k1 = 0.1, camera_k1_sigmas = 4.5;
    double camera_k1_known = 0.04;  ///< sigma above which the surface is too small to tell
    double projector_bent_px = 0.07;
};

/// A rig checked against one scan of anything: a board, a phantom, the patient.
struct DriftCheck {
    enum class Verdict { good, projector_moved, cameras_moved, lens_changed, distortion_wrong, cannot_tell };
    Verdict verdict = Verdict::cannot_tell;
    std::string reason, remedy;  ///< remedy empty when good
    std::size_t points = 0;
    double epipolar_px = 0;           ///< `usual_epipolar_px`
    double projector_rms_px = 0;      ///< as calibrated; 0, as all below: not known, too few points fit to place it
    double projector_after_px = 0;    ///< placed anew by this scan
    BentResiduals bent;               ///< with the projector placed anew
    double light_off_mm = 0;          ///< what `projector_rms_px` is on the surface
    double moved_mm = 0, turned = 0;  ///< of the projector against the rig file; radians
};

/// As `check --json` says it.
const char* text_of(DriftCheck::Verdict verdict);

/// Judged on what both cameras saw of whatever was scanned; `cannot_tell` where that is too little.
DriftCheck check_drift(const ScanResult& scan, const RigCalibration& rig, const DriftLimits& limits = {});

/// A check of an earlier day.
struct EarlierCheck {
    double day = 0;                                ///< any origin
    double epipolar_px = 0, projector_rms_px = 0;  ///< 0: not known
};

/// Where the checks are heading: a straight line through them, where there are at least four over at least two days and
/// it rises by more than twice its own standard error. Empty: no trend.
struct DriftTrend {
    std::string what;  ///< "epipolar error" or "projector"
    double px_per_day = 0;
    double days_to_limit = 0;  ///< from the last check; 0 when the limit is reached
};

/// The epipolar error before the projector; empty when nothing rises.
std::vector<DriftTrend> drift_trends(const std::vector<EarlierCheck>& checks, const DriftLimits& limits = {});

}  // namespace planlight
