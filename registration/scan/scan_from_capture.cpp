#include <fmt/format.h>

#include <chrono>
#include <stdexcept>

#include "registration/scan/scan_surface.h"

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

}  // namespace

ScanResult scan_from_capture(const ScanCapture& capture, const RigCalibration& rig, const ScanSettings& settings) {
    if (capture.stripes.width != rig.projector.width || capture.stripes.height != rig.projector.height)
        throw std::invalid_argument(fmt::format("scan_from_capture: stripes of {} x {} for a projector calibrated at {} x {}",
                                                capture.stripes.width, capture.stripes.height, rig.projector.width,
                                                rig.projector.height));
    ScanResult result;
    Stopwatch watch;
    result.left = decode_stripes(capture.left, capture.stripes, settings.decode);
    result.right = decode_stripes(capture.right, capture.stripes, settings.decode);
    check_size(result.left, rig.left_camera, "left");
    check_size(result.right, rig.right_camera, "right");
    result.decode_s = watch.lap_s();
    RigCalibration rig_now = rig;
    result.raw = triangulate(result.left, result.right, rig, settings.triangulation);
    if (capture.stripes.rows) result.resection = resect_projector(result.raw, rig, settings.resection);
    if (settings.use_resection && result.resection && result.resection->believable) {
        rig_now.projector = result.resection->projector;
        result.raw = triangulate(result.left, result.right, rig_now, settings.triangulation);
        result.resection_used = true;
    }
    result.triangulate_s = watch.lap_s();
    result.clean = remove_outliers(result.raw, rig_now, settings.outliers);
    result.outliers_s = watch.lap_s();
    return result;
}

}  // namespace planlight
