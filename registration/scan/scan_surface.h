#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "registration/devices/projector.h"
#include "registration/devices/stereo_camera.h"
#include "registration/scan/check/check_sequence.h"
#include "registration/scan/clean/remove_outliers.h"
#include "registration/scan/decode/decode_stripes.h"
#include "registration/scan/triangulate/find_rig_state.h"
#include "registration/scan/triangulate/resect_projector.h"
#include "registration/scan/triangulate/triangulate.h"

namespace planlight {

/// The frames of one scan: one per pattern, in the order of the sequence.
struct ScanCapture {
    StripeSettings stripes;
    bool check_sequence = true;          ///< false: it is known to be right whatever it looks like (see ScanSettings)
    std::vector<GrayImage> left, right;  ///< `right` empty: one camera
    Instant began{}, ended{};            ///< mid-exposure of the first and last frame
    /// What was captured, when it is not the whole of `stripe_sequence(stripes)`: a Gray code without fringes
    /// (`stripes.phase_steps` 0), or without its finest bits. Empty: the whole sequence.
    std::vector<StripePattern> partial;
};

/// Shows every pattern and keeps the frame that saw it. The projector is dark afterwards, however it ends. Where the
/// cameras tell when their shutters have closed, the next pattern is ordered before the frame has come.
/// `progress(done, of)` is called after every picture and may be empty. Throws DeviceError when a device fails.
ScanCapture capture_scan(Projector& projector, StereoCamera& cameras, const Clock& clock, const StripeSettings& stripes,
                         const std::function<void(int, int)>& progress = {});

/// Of every step of a scan, from pictures to cloud.
struct ScanSettings {
    DecodeSettings decode;
    TriangulationSettings triangulation;
    OutlierSettings outliers;
    ResectionSettings resection;
    RigStateSettings rig;
    /// Take the rig as the scan finds it (`ScanResult::rig`): every device if one moved, and the projector where the
    /// resection is believable. False: as calibrated, whatever the scan says.
    bool use_resection = true;
    bool check_sequence = true;  ///< refuse a capture in which a frame does not show its own picture
};

/// A scan from pictures to clean cloud, with everything in between for the report (Fig. 2).
struct ScanResult {
    DecodedView left, right;
    SequenceCheck left_sequence, right_sequence;  ///< not checked: too few lit pixels, or not asked for
    Triangulation raw;
    OutlierReport clean;
    /// The projector against rig.json by the cameras as calibrated; empty: too few points, or columns only.
    std::optional<Resection> resection;
    bool resection_used = false;  ///< `rig.rig` has the projector elsewhere than rig.json
    /// What the scan found of the rig, and the rig that `raw` and `clean` are made with; `calibrated` and
    /// `capture_hash` in it are the caller's to fill.
    RigState rig;
    double epipolar_as_calibrated_px = 0;  ///< `usual_epipolar_px` by rig.json; 0: not known
    /// How finely the light could be read, projector pixels: 0 by the fringes, to fractions of one; else the finest
    /// cell of the Gray code, because there were no fringes, or none that the optics resolved.
    double code_step_px = 0;
    double sequence_s = 0, decode_s = 0, triangulate_s = 0, outliers_s = 0;
};

/// The cloud of a capture. An empty cloud is a value (nothing was lit); the counts say why.
///
/// Of three devices any two do: a rig without a right camera, or a capture without its pictures, is scanned by the left
/// camera and the projector; a rig without a projector by both cameras, which find partners by the code (normals then
/// look towards the left camera). `resection` needs all three. Throws std::invalid_argument when less is there;
/// CheckFailedError, naming the picture, when a frame is late, doubled, missing or swapped
/// (`ScanSettings::check_sequence`), and when the pictures are a colour camera's raw mosaic.
ScanResult scan_from_capture(const ScanCapture& capture, const RigCalibration& rig, const ScanSettings& settings = {});

}  // namespace planlight
