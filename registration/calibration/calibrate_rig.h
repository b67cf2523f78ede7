#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/rig_calibration.h"
#include "registration/calibration/volume_error.h"

namespace planlight {

/// From when on captures are too few, too alike or too bad for a rig.
struct CalibrationSettings {
    BundleSettings bundle;
    int folds = 4;  ///< the poses are held out in so many groups, one after the other
    std::size_t least_poses = 3;
    double least_tilt_range = 0.26;  ///< radians (15 degrees): the largest angle between two poses of the board
    double alike_angle = 0.05, alike_mm = 10;  ///< poses nearer than this to an earlier one count as the same
    double max_saturated = 0.05;               ///< share of the board's pixels
    double min_contrast_grey =
        12;  ///< white less black light on the board; of the white picture itself without coded light
    double max_moved_px = 0.25;  ///< of the board while a pose was captured
    double min_decoded = 0.2;  ///< of the board's lit pixels (a board printed black decodes on its white squares only)
    double max_rms_px = 1.0;   ///< of a camera, of the light
    /// Together against each by itself: a camera's corners in the pair against alone, the light of all poses against
    /// that of a pose whose projector may stand anywhere. More is a device that was moved between poses, by however
    /// little.
    double max_worse_together = 1.6;
    double max_board_stretch = 0.005;  ///< of its height against its width, as both cameras see it alike
    double max_left_out = 0.2;         ///< share of corners or lit pixels that may disagree with the rest
    double max_predicted_mm = 1.0;     ///< 95 % of the working volume, of scanned points and of light sent to them
};

/// Why a calibration is refused, and what to do.
struct Refusal {
    std::string reason, remedy;
};

/// Differences on poses that the calibration did not see (only the board's own pose is fitted to them).
struct HeldOut {
    std::array<double, 3> rms_px{};  ///< length of the 2-D difference, by DeviceName
    std::array<std::size_t, 3> used{}, left_out{};
    std::size_t lengths = 0;    ///< distances on the board measured by the rig, 150 to 250 mm where the board has them
    double length_rms_mm = 0;   ///< of a distance's error, taken to 200 mm
    double length_mean_mm = 0;  ///< the part that all share: scale
};

/// A rig with its uncertainty, or the refusal.
struct Calibration {
    BundleResult bundle;  ///< from all poses
    HeldOut held_out;
    std::optional<VolumeError> volume;  ///< with two devices or more
    std::vector<std::string> warnings;
    std::optional<Refusal> refusal;  ///< then nothing else may be used

    const std::optional<CameraModel>& device(DeviceName name) const { return bundle.rig.device(name); }
    /// What rig.json is written of: the left camera and another device.
    bool makes_a_rig() const {
        return device(DeviceName::left_camera) && (device(DeviceName::right_camera) || device(DeviceName::projector));
    }
    bool whole_rig() const {
        return device(DeviceName::left_camera) && device(DeviceName::right_camera) && device(DeviceName::projector);
    }
};

/// From what the cameras saw of the board to the rig. `projector_width` 0: no projector. Bad input of any kind ends in
/// `refusal`, never in a rig.
Calibration calibrate_rig(const std::vector<PoseObservation>& poses, const BoardSpec& board, int projector_width,
                          int projector_height, const CalibrationSettings& settings = {});

/// For rig.json; the calibration must be of two devices at least. `made_on`: ISO 8601.
RigCalibration rig_calibration_of(const Calibration& calibration, const std::string& made_on);

}  // namespace planlight
