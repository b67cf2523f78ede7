#include "registration/calibration/camera_fits.h"

#include <algorithm>

#include "registration/calibration/initial_calibration.h"

namespace planlight {

double share_left_out(const BundleResult& bundle, DeviceName name) {
    const auto d = static_cast<std::size_t>(name);
    const auto all = static_cast<double>(bundle.used[d] + bundle.left_out[d]);
    return all > 0 ? static_cast<double>(bundle.left_out[d]) / all : 0;
}

double rms_of(const BundleResult& bundle, DeviceName name) {
    return bundle.rms_px[static_cast<std::size_t>(name)];
}

BundleResult adjust_corners(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                            const CalibrationSettings& settings) {
    const InitialCalibration start = calibrate_cameras_initially(poses, board);
    BundleSettings corners = settings.bundle;
    corners.light = false;
    return start.failure.empty() ? adjust_bundle(poses, board, start.rig, corners) : BundleResult{};
}

BundleResult camera_alone(const std::vector<PoseObservation>& poses, const BoardSpec& board, DeviceName camera,
                          const CalibrationSettings& settings) {
    std::vector<PoseObservation> own = poses;
    for (PoseObservation& pose : own) {
        if (camera == DeviceName::right_camera) pose.left = pose.right;
        pose.right = {};
    }
    return adjust_corners(own, board, settings);
}

bool cameras_fit(const BundleResult& bundle, const CalibrationSettings& s) {
    return bundle.converged && std::all_of(kCameras.begin(), kCameras.end(), [&](DeviceName c) {
               return rms_of(bundle, c) <= s.max_rms_px && share_left_out(bundle, c) <= s.max_left_out;
           });
}

std::optional<WorseTogether> worse_together(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                            const BundleResult& cameras, const CalibrationSettings& s) {
    if (!cameras.rig.device(DeviceName::right_camera)) return std::nullopt;
    for (const DeviceName camera : kCameras) {
        const BundleResult alone = camera_alone(poses, board, camera, s);
        const double by_itself = alone.sigma_px[0], together = cameras.sigma_px[static_cast<std::size_t>(camera)];
        if (alone.converged && together > s.max_worse_together * by_itself + kResidualFloor_px)
            return WorseTogether{camera, by_itself, together};
    }
    return std::nullopt;
}

}  // namespace planlight
