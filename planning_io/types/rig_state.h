#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/rig_calibration.h"

namespace planlight {

/// A small difference between two models of one device, about which it is linear: a turn (rotation vector, radians) and
/// a shift (mm) of the scene in the device's frame, the logarithm of the focal length, the principal point (pixels),
/// k1.
using DeviceChange = Eigen::Matrix<double, 10, 1>;

/// `device` with the change applied; exact for the turn, the rest as DeviceChange says.
CameraModel changed(CameraModel device, const DeviceChange& change);

/// The devices of a rig, in this order wherever an array is by device.
enum class RigDevice { left_camera, right_camera, projector };
inline constexpr std::size_t kRigDevices = 3;

/// "left camera", "right camera", "projector".
const char* text_of(RigDevice device);

/// The device's model; the rig must hold it.
const CameraModel& device_of(const RigCalibration& rig, RigDevice device);
CameraModel& device_of(RigCalibration& rig, RigDevice device);

/// Which rig.json a scan began with.
struct RigName {
    std::string hash;  ///< XXH3-128 of its numbers (`hash_of` in rig_file.h); empty: not known
    std::string made_on;
    DeviceSerials serials;
    bool known() const { return !hash.empty(); }
    bool operator==(const RigName&) const = default;
};

/// Another rig that explains a scan nearly as well as the one that is used: the change from `RigState::rig` to it, in
/// the gauge in which both clouds lie on each other as well as a rigid motion can lay them.
struct RigDoubt {
    std::string what;                          ///< in words, "the left camera moved"
    double chi_square = 0;                     ///< by how much worse it explains the scan
    bool sigma = false;                        ///< one standard deviation of the rig that is used, not another one
    std::array<DeviceChange, kRigDevices> by;  ///< by RigDevice
};

/// What a scan found about one device.
struct DeviceFinding {
    bool moved = false;               ///< it, and not another, is what moved or was changed
    bool maybe = false;               ///< it, or another one
    bool best = false;                ///< the explanation that costs least has it so
    bool lens = false;                ///< ... and there its lens was changed (focus, zoom or shift)
    double moved_mm = 0, turned = 0;  ///< against rig.json; of the device's centre, of its axes (radians)
    double focal_change = 0;          ///< relative
};

/// The rig as a scan found it: one per session. The cloud was made with `rig`, the patient is followed and the light is
/// drawn with `rig`, so that what the scan saw lit by a pixel is lit by that pixel again.
struct RigState {
    enum class Verdict {
        unknown,        ///< nothing could be checked: no scan, columns only, fewer devices, coarse light
        as_calibrated,  ///< nothing moved by more than a good calibration's own error
        corrected,      ///< something moved, and where to is known well enough
        not_trusted,    ///< something moved, and what the light may be off by is more than may be hidden
    };
    Verdict verdict = Verdict::unknown;
    std::string sentence;                            ///< what was found, in words
    std::string remedy;                              ///< empty where there is nothing to do
    RigName calibrated;                              ///< the rig.json that it began with
    std::string capture_hash;                        ///< of the capture it was found in; empty: not known
    RigCalibration rig;                              ///< as found
    std::array<DeviceFinding, kRigDevices> devices;  ///< by RigDevice
    std::vector<RigDoubt> doubts;
    double accepted_movement_mm = 0;  ///< the patient moved so far in that scan, and a person took it all the same
    double hidden_light_mm = 0;  ///< how far off the light may be without a sign of it, over the scanned surface, 95 %

    /// Something moved: `rig` is not rig.json.
    bool moved() const { return verdict == Verdict::corrected || verdict == Verdict::not_trusted; }
    bool checked() const { return verdict == Verdict::as_calibrated || verdict == Verdict::corrected; }
};

/// In words: "as calibrated" and so on.
const char* text_of(RigState::Verdict verdict);

/// The point that three pixels see best (0.1 px the cameras, 0.25 px the projector), rig, mm, from a start near it;
/// empty when it does not settle. Pixels by RigDevice.
using DevicePixels = std::array<Eigen::Vector2d, kRigDevices>;
std::optional<Eigen::Vector3d> point_of_pixels(const RigCalibration& rig, const DevicePixels& pixels,
                                               const Eigen::Vector3d& near);

/// The rig that a doubt means.
RigCalibration doubted(const RigCalibration& rig, const RigDoubt& doubt);

/// How far from where it is wanted light may fall at a point because of what the scan could not tell (95 %), mm: the
/// farthest of the other rigs, and twice the standard deviations of the one that is used. 0 without doubts.
double hidden_light_mm(const RigState& state, const Eigen::Vector3d& p_in_rig);

}  // namespace planlight
