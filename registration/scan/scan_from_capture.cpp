#include <fmt/format.h>

#include <chrono>
#include <limits>
#include <stdexcept>
#include <utility>

#include "registration/scan/decode_capture.h"
#include "registration/scan/scan_surface.h"
#include "registration/scan/triangulate_cameras.h"

namespace planlight {
namespace {

class Stopwatch {
public:
    /// Seconds since the last call (or since the start).
    double lap_s() {
        const auto now = std::chrono::steady_clock::now();
        const double passed_s = std::chrono::duration<double>(now - last_).count();
        last_ = now;
        return passed_s;
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void check_size(const DecodedView& view, const CameraModel& camera, const char* name) {
    if (view.width != camera.width || view.height != camera.height)
        throw std::invalid_argument(
            fmt::format("scan_from_capture: {} frames of {} x {} for a camera calibrated at {} x {}", name, view.width,
                        view.height, camera.width, camera.height));
}

/// A view in which nothing is seen, for the camera that is not there.
DecodedView blind_view(bool rows) {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    DecodedView view;
    view.width = view.height = 1;
    view.column = view.sigma_px = {kNaN};
    if (rows) view.row = {kNaN};
    return view;
}

void check_devices(const ScanCapture& capture, const RigCalibration& rig) {
    if (!present(rig.projector) && (capture.right.empty() || !present(rig.right_camera)))
        throw std::invalid_argument("scan_from_capture: one camera and no projector");
    if (!present(rig.projector)) return;
    if (capture.stripes.width != rig.projector.width || capture.stripes.height != rig.projector.height)
        throw std::invalid_argument(fmt::format("scan_from_capture: stripes of {} x {} for a projector calibrated at {} x {}",
                                                capture.stripes.width, capture.stripes.height, rig.projector.width,
                                                rig.projector.height));
}

void decode(const ScanCapture& capture, const RigCalibration& rig, const DecodeSettings& settings, ScanResult& result) {
    DecodedCapture decoded = decode_capture(capture, present(rig.right_camera), settings);
    result.left = std::move(decoded.left);
    check_size(result.left, rig.left_camera, "left");
    result.code_step_px = decoded.step_px;
    if (decoded.right) {
        result.right = std::move(*decoded.right);
        check_size(result.right, rig.right_camera, "right");
    } else {
        result.right = blind_view(!result.left.row.empty());
    }
}

/// The points, and the rig they were made with: its projector may be one that the scan placed anew.
RigCalibration place_points(const ScanCapture& capture, const RigCalibration& rig, const ScanSettings& settings,
                            ScanResult& result) {
    RigCalibration rig_now = rig;
    if (!present(rig.projector)) {
        result.raw = triangulate_cameras(result.left, result.right, rig, capture.stripes.width, capture.stripes.height,
                                         settings.triangulation);
        rig_now.projector = rig.left_camera;  // for what asks where the surface is looked at from
        return rig_now;
    }
    result.raw = triangulate(result.left, result.right, rig, settings.triangulation);
    if (capture.stripes.rows) result.resection = resect_projector(result.raw, rig, settings.resection);
    if (settings.use_resection && result.resection && result.resection->believable) {
        rig_now.projector = result.resection->projector;
        result.raw = triangulate(result.left, result.right, rig_now, settings.triangulation);
        result.resection_used = true;
    }
    return rig_now;
}

}  // namespace

ScanResult scan_from_capture(const ScanCapture& capture, const RigCalibration& rig, const ScanSettings& settings) {
    check_devices(capture, rig);
    ScanResult result;
    Stopwatch watch;
    decode(capture, rig, settings.decode, result);
    result.decode_s = watch.lap_s();
    const RigCalibration rig_now = place_points(capture, rig, settings, result);
    result.triangulate_s = watch.lap_s();
    result.clean = remove_outliers(result.raw, rig_now, settings.outliers);
    result.outliers_s = watch.lap_s();
    return result;
}

}  // namespace planlight
