#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <chrono>
#include <stdexcept>
#include <utility>

#include "planning_io/types/error.h"
#include "registration/scan/place_matches.h"
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

/// The check of one camera's frames; empty where they are not the whole sequence.
SequenceCheck sequence_of(const std::vector<GrayImage>& frames, const StripeSettings& stripes) {
    const bool whole = stripes.phase_steps >= 3 && frames.size() == stripe_sequence(stripes).size();
    return whole ? check_sequence(frames, stripes) : SequenceCheck{};
}

void refuse_wrong_sequence(const ScanCapture& capture, ScanResult& result) {
    tbb::parallel_invoke([&] { result.left_sequence = sequence_of(capture.left, capture.stripes); },
                         [&] { result.right_sequence = sequence_of(capture.right, capture.stripes); });
    for (const auto& [check, camera] : {std::pair{&result.left_sequence, "left"}, {&result.right_sequence, "right"}})
        if (!check->problems.empty())
            throw CheckFailedError(fmt::format("the {} camera's frames do not show the sequence: {} ({:.0f} % of the lit pixels)",
                                               camera, check->problems[0].what, 100 * check->problems[0].share),
                                   "Scan again; if it comes back, check the delay between projector and cameras and the "
                                   "names of the pictures.");
}

bool use_resection(const ScanSettings& settings, ScanResult& result, RigCalibration& rig) {
    if (!settings.use_resection || !result.resection || !result.resection->believable) return false;
    rig.projector = result.resection->projector;
    return true;
}

/// The codes are matched once; where the projector stands is found from a part of the matches, then all are placed.
void triangulate_and_resect(const ScanSettings& settings, ScanResult& result, RigCalibration& rig) {
    if (result.left.row.empty() || result.right.row.empty()) {
        result.raw = triangulate(result.left, result.right, rig, settings.triangulation);
        return;
    }
    constexpr std::size_t kEnough = 10000;
    const ViewMatches matches = match_views(result.left, result.right, rig, settings.triangulation);
    TriangulationSettings by_cameras = settings.triangulation;
    by_cameras.one_camera = false;
    result.resection =
        resect_projector(place_matches(matches, rig, by_cameras, 1 + matches.both.size() / kEnough), rig, settings.resection);
    result.resection_used = use_resection(settings, result, rig);
    result.raw = place_matches(matches, rig, settings.triangulation);
}

}  // namespace

ScanResult scan_from_capture(const ScanCapture& capture, const RigCalibration& rig, const ScanSettings& settings) {
    if (capture.stripes.width != rig.projector.width || capture.stripes.height != rig.projector.height)
        throw std::invalid_argument(fmt::format("scan_from_capture: stripes of {} x {} for a projector calibrated at {} x {}",
                                                capture.stripes.width, capture.stripes.height, rig.projector.width,
                                                rig.projector.height));
    ScanResult result;
    Stopwatch watch;
    if (settings.check_sequence) refuse_wrong_sequence(capture, result);
    result.sequence_s = watch.lap_s();
    result.left = decode_stripes(capture.left, capture.stripes, settings.decode);
    result.right = decode_stripes(capture.right, capture.stripes, settings.decode);
    check_size(result.left, rig.left_camera, "left");
    check_size(result.right, rig.right_camera, "right");
    result.decode_s = watch.lap_s();
    RigCalibration rig_now = rig;
    triangulate_and_resect(settings, result, rig_now);
    result.triangulate_s = watch.lap_s();
    result.clean = remove_outliers(result.raw, rig_now, settings.outliers);
    result.outliers_s = watch.lap_s();
    return result;
}

}  // namespace planlight
