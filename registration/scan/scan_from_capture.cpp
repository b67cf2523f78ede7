#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <utility>

#include "planning_io/types/error.h"
#include "registration/devices/colour_mosaic.h"
#include "registration/scan/check/camera_gamma.h"
#include "registration/scan/check/panel_ends.h"
#include "registration/scan/decode/decode_capture.h"
#include "registration/scan/decode/merge_exposures.h"
#include "registration/scan/scan_surface.h"
#include "registration/scan/triangulate/triangulate_cameras.h"
#include "registration/scan/triangulate/triangulate_matches.h"

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

/// The check of one camera's frames; empty where it has none.
SequenceCheck sequence_of(const std::vector<GrayImage>& frames, const ScanCapture& capture) {
    if (frames.empty()) return {};
    if (!capture.partial.empty()) return check_sequence(frames, capture.stripes, capture.partial);
    const bool whole = capture.stripes.phase_steps >= 3 && frames.size() == stripe_sequence(capture.stripes).size();
    return whole ? check_sequence(frames, capture.stripes) : SequenceCheck{};
}

void refuse_wrong_sequence(const ScanCapture& capture, ScanResult& result) {
    tbb::parallel_invoke([&] { result.left_sequence = sequence_of(capture.left, capture); },
                         [&] { result.right_sequence = sequence_of(capture.right, capture); });
    const auto judge = [&](const SequenceCheck& check, const std::vector<GrayImage>& frames, const char* camera) {
        if (check.problems.empty()) return;
        throw CheckFailedError(
            fmt::format("the {} camera's frames do not show the sequence: {} ({:.0f} % of the lit pixels){}", camera,
                        check.problems[0].what, 100 * check.problems[0].share,
                        said_of_gamma(camera_gamma(frames, uniform_light_frames(capture)))),
            remedy_of(check.problems[0]) + " \"check_sequence\": false in capture.json takes them as they are.");
    };
    judge(result.left_sequence, capture.left, "left");
    judge(result.right_sequence, capture.right, "right");
}

/// After decoding. White and black are the first two pictures of a whole sequence.
void refuse_wrong_panel(const ScanCapture& capture, const ScanResult& result) {
    if (!capture.partial.empty()) return;
    const auto judge = [&](const DecodedView& view, const std::vector<GrayImage>& frames, const char* camera) {
        if (frames.size() < 2 || view.width != frames[0].width || view.height != frames[0].height) return;
        if (const auto problem = check_panel_ends(view, frames[0], frames[1], capture.stripes))
            throw CheckFailedError(
                fmt::format("the {} camera's frames do not show the sequence: {}", camera, problem->what),
                remedy_of(*problem) + " \"check_sequence\": false in capture.json takes them as they are.");
    };
    judge(result.left, capture.left, "left");
    judge(result.right, capture.right, "right");
}

/// The light must be read to this many projector pixels to judge a rig by it.
constexpr double kFineLight_px = 2;

void place_projector(const std::optional<Resection>& resection, RigCalibration& rig) {
    if (resection && resection->believable) rig.projector = resection->projector;
}

/// The codes are matched once; where the devices stand is found from a part of the matches, then all are placed.
void triangulate_and_resect(const ScanSettings& settings, ScanResult& result, RigCalibration& rig) {
    if (result.left.row.empty() || result.right.row.empty()) {
        result.rig.sentence =
            "whether the rig moved is not known: the light codes the projector's columns only (the full set codes rows "
            "as well)";
        result.raw = triangulate(result.left, result.right, rig, settings.triangulation);
        return;
    }
    constexpr std::size_t kEnough = 6000;
    const ViewMatches matches = match_views(result.left, result.right, rig, settings.triangulation);
    TriangulationSettings by_cameras = settings.triangulation;
    by_cameras.one_camera = false;
    const auto resected = [&] {
        const Triangulation some = triangulate_matches(matches, rig, by_cameras, 1 + matches.both.size() / kEnough);
        if (result.epipolar_as_calibrated_px == 0) result.epipolar_as_calibrated_px = usual_epipolar_px(some);
        return resect_projector(some, rig, settings.resection);
    };
    const RigidTransform as_calibrated = rig.projector.device_from_rig;
    result.resection = resected();
    if (result.code_step_px > kFineLight_px)
        result.rig.sentence = "whether the rig moved is not known: the light was read too coarsely";
    else
        result.rig = find_rig_state(matches, rig, settings.rig);
    const bool adjusted =
        result.rig.verdict == RigState::Verdict::as_calibrated &&
        result.rig.rig.left_camera.device_from_rig.matrix() != rig.left_camera.device_from_rig.matrix();
    if (settings.use_resection && (result.rig.moved() || adjusted)) {
        rig = result.rig.rig;
        place_projector(resected(), rig);
    } else if (settings.use_resection) {
        place_projector(result.resection, rig);
    }
    result.resection_used = rig.projector.device_from_rig.matrix() != as_calibrated.matrix();
    result.raw = triangulate_matches(matches, rig, settings.triangulation);
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
        throw std::invalid_argument(
            fmt::format("scan_from_capture: stripes of {} x {} for a projector calibrated at {} x {}",
                        capture.stripes.width, capture.stripes.height, rig.projector.width, rig.projector.height));
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
RigCalibration triangulate_points(const ScanCapture& capture, const RigCalibration& rig, const ScanSettings& settings,
                                  ScanResult& result) {
    RigCalibration rig_now = rig;
    result.rig.sentence = "whether the rig moved is not known: it takes both cameras and the projector to tell";
    if (!present(rig.projector)) {
        result.rig.rig = rig;
        result.raw = triangulate_cameras(result.left, result.right, rig, capture.stripes.width, capture.stripes.height,
                                         settings.triangulation);
        rig_now.projector = rig.left_camera;  // for what asks where the surface is looked at from
        return rig_now;
    }
    triangulate_and_resect(settings, result, rig_now);
    result.rig.rig = rig_now;
    return rig_now;
}

}  // namespace

ScanResult scan_from_exposures(std::span<const ScanCapture> captures, const RigCalibration& rig,
                               const ScanSettings& settings) {
    if (captures.empty()) throw std::invalid_argument("scan_from_exposures: no capture");
    ScanResult result;
    Stopwatch watch;
    for (const ScanCapture& capture : captures) {
        check_devices(capture, rig);
        if (!capture.left.empty()) refuse_colour_mosaic(capture.left.front(), "left");
        if (!capture.right.empty()) refuse_colour_mosaic(capture.right.front(), "right");
        ScanResult one;
        if (settings.check_sequence && capture.check_sequence) refuse_wrong_sequence(capture, one);
        result.sequence_s += watch.lap_s();
        decode(capture, rig, settings.decode, one);
        if (settings.check_sequence && capture.check_sequence) refuse_wrong_panel(capture, one);
        if (&capture == &captures.front()) {
            std::swap(result, one);
            result.sequence_s = one.sequence_s;
        } else {
            take_better(result.left, one.left);
            take_better(result.right, one.right);
            result.code_step_px = std::max(result.code_step_px, one.code_step_px);
        }
        result.decode_s += watch.lap_s();
    }
    const RigCalibration rig_now = triangulate_points(captures.front(), rig, settings, result);
    result.triangulate_s = watch.lap_s();
    result.clean = remove_outliers(result.raw, rig_now, settings.outliers);
    result.outliers_s = watch.lap_s();
    return result;
}

ScanResult scan_from_capture(const ScanCapture& capture, const RigCalibration& rig, const ScanSettings& settings) {
    return scan_from_exposures(std::span(&capture, 1), rig, settings);
}

}  // namespace planlight
