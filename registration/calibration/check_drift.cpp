#include "registration/calibration/check_drift.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace planlight {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// What a projector pixel is on the points, mm.
double mm_per_px(const Triangulation& raw, const CameraModel& projector) {
    double sum = 0;
    for (const auto& point : raw.by_cameras)
        sum += (projector.device_from_rig * point.p_in_rig).z() / projector.focal_x;
    return raw.by_cameras.empty() ? 0 : sum / static_cast<double>(raw.by_cameras.size());
}

constexpr const char* kOtherDistortion =
    "If rig.json was written by another program, see that its distortion has the right sign; else calibrate again.";

constexpr const char* kAnotherRig =
    "Look whether this is the rig file of this room, and whether left and right are exchanged; if neither, calibrate "
    "the rig again.";
constexpr const char* kNotInView =
    "Put the board or the patient where both cameras see it under the light. If it is there, calibrate the rig again.";

bool cameras_bent(const BentResiduals& bent, const DriftLimits& limits) {
    const double off = std::abs(bent.k1_off);
    return bent.k1_sigma < limits.camera_k1_known && off > limits.camera_k1 &&
           off > limits.camera_k1_sigmas * bent.k1_sigma;
}

/// Empty where the light was read well enough to judge a rig by it.
std::string unfit(const ScanResult& scan, const DriftLimits& limits) {
    if (scan.code_step_px > limits.code_step_px)
        return fmt::format("the light was read to {:.0f} projector pixels; to judge the rig it takes {:.0f}",
                           scan.code_step_px, limits.code_step_px);
    if (scan.left.row.empty() || scan.right.row.empty())
        return "the light codes columns only; to judge the rig it takes rows too";
    return {};
}

/// What the joint adjustment of the three devices found, in the same words as the scan and the light have it.
void decide_by_state(DriftCheck& check, const RigState& state) {
    using Verdict = DriftCheck::Verdict;
    const auto best = [&](RigDevice device) { return state.devices[static_cast<std::size_t>(device)].best; };
    const bool cameras = best(RigDevice::left_camera) || best(RigDevice::right_camera);
    const bool lens = state.devices[static_cast<std::size_t>(RigDevice::projector)].lens;
    check.verdict = cameras ? Verdict::cameras_moved : lens ? Verdict::lens_changed : Verdict::projector_moved;
    check.reason = state.sentence;
    check.remedy = state.remedy;
    constexpr double kBump_mm = 50, kBump_rad = 0.05;  // nothing that is knocked stands so far from its place
    const bool elsewhere = std::any_of(state.devices.begin(), state.devices.end(), [](const DeviceFinding& f) {
        return f.moved_mm > kBump_mm || f.turned > kBump_rad;
    });
    if (!elsewhere) return;
    check.reason = "the devices do not stand at all as this rig file has them (" + state.sentence + ")";
    check.remedy = kAnotherRig;
}

/// `placed`: the points were enough to place the projector by them. Moved cameras are told first: then they may not be.
/// `state`: what all devices together tell of a surface too small to place the projector by it alone (a face).
void decide(DriftCheck& check, bool placed, const RigState& state, const DriftLimits& limits) {
    using Verdict = DriftCheck::Verdict;
    constexpr double kLittle_mm = 1;
    if (check.points < limits.min_points) {
        check.reason = fmt::format(
            "only {} points are seen by both cameras under the light; {} over a good part of the picture are needed",
            check.points, limits.min_points);
        check.remedy = kNotInView;
    } else if (check.epipolar_px > limits.epipolar_px) {
        check.verdict = Verdict::cameras_moved;
        check.reason = fmt::format(
            "the cameras do not fit each other any more: {:.2f} px from the epipolar lines; {:.2f} is the limit",
            check.epipolar_px, limits.epipolar_px);
        constexpr double kBump_px = 8;
        check.remedy = check.epipolar_px > kBump_px ? kAnotherRig : "Calibrate the rig again.";
    } else if (!placed && state.verdict == RigState::Verdict::as_calibrated && state.hidden_light_mm < kLittle_mm) {
        check.verdict = Verdict::good;
        check.reason = fmt::format(
            "the rig is as it was calibrated, as far as a surface of this size tells: light could be {:.1f} mm off "
            "without a sign of it (95 %)",
            std::ceil(10 * state.hidden_light_mm) / 10);
    } else if (!placed) {
        check.reason = "what both cameras see under the light lies too close together to place the projector by it";
        check.remedy = kNotInView;
    } else if (check.projector_after_px > limits.projector_after_px) {
        check.verdict = Verdict::lens_changed;
        check.reason = fmt::format(
            "the projector fits from no place ({:.2f} px left; {:.2f} is the limit): its zoom, focus or keystone was "
            "changed",
            check.projector_after_px, limits.projector_after_px);
        check.remedy = "Set zoom, focus and keystone back, or calibrate the rig again.";
    } else if (cameras_bent(check.bent, limits)) {
        check.verdict = Verdict::distortion_wrong;
        check.reason = fmt::format(
            "the distances from the epipolar lines are bent as by a wrong lens: a distortion k1 of the left or right "
            "camera is "
            "off by about {:.2f} ({:.2f} is the limit)",
            std::abs(check.bent.k1_off), limits.camera_k1);
        check.remedy = kOtherDistortion;
    } else if (check.bent.projector_px > limits.projector_bent_px) {
        check.verdict = Verdict::distortion_wrong;
        check.reason = fmt::format(
            "the light is bent against the rig from place to place ({:.3f} px rms; {:.3f} is the limit), as by a wrong "
            "distortion "
            "of the projector or of both cameras",
            check.bent.projector_px, limits.projector_bent_px);
        check.remedy = kOtherDistortion;
    } else if (check.projector_rms_px > limits.projector_px) {
        check.verdict = Verdict::projector_moved;
        check.reason =
            fmt::format("the projector moved by {:.2f} mm and {:.3f} degrees: light would land {:.2f} mm off",
                        check.moved_mm, check.turned * kDegrees, check.light_off_mm);
        check.remedy = "The light is drawn with the projector where the scan finds it; calibrate the rig again.";
    } else {
        check.verdict = Verdict::good;
        check.reason = "the rig is as it was calibrated";
    }
}

struct Line {
    double slope = 0, slope_sigma = 0, at_last = 0;
};

Line fit_line(const std::vector<EarlierCheck>& checks, double EarlierCheck::*value) {
    const auto n = static_cast<double>(checks.size());
    double mean_day = 0, mean = 0, days = 0, both = 0, rest = 0;
    for (const auto& c : checks) mean_day += c.day / n, mean += c.*value / n;
    for (const auto& c : checks)
        days += (c.day - mean_day) * (c.day - mean_day), both += (c.day - mean_day) * (c.*value - mean);
    Line line;
    line.slope = both / days;
    for (const auto& c : checks) rest += std::pow(c.*value - mean - line.slope * (c.day - mean_day), 2);
    line.slope_sigma = std::sqrt(rest / (n - 2) / days);
    line.at_last = mean + line.slope * (checks.back().day - mean_day);
    return line;
}

}  // namespace

const char* text_of(DriftCheck::Verdict verdict) {
    switch (verdict) {
        case DriftCheck::Verdict::good:
            return "good";
        case DriftCheck::Verdict::projector_moved:
            return "projector moved";
        case DriftCheck::Verdict::cameras_moved:
            return "cameras moved";
        case DriftCheck::Verdict::lens_changed:
            return "lens changed";
        case DriftCheck::Verdict::distortion_wrong:
            return "distortion wrong";
        case DriftCheck::Verdict::cannot_tell:
            break;
    }
    return "cannot tell";
}

DriftCheck check_drift(const ScanResult& scan, const RigCalibration& rig, const DriftLimits& limits) {
    DriftCheck check;
    check.points = scan.raw.by_cameras.size();
    const bool moved = scan.rig.moved();
    check.epipolar_px =
        scan.epipolar_as_calibrated_px > 0 ? scan.epipolar_as_calibrated_px : usual_epipolar_px(scan.raw);
    if (scan.resection) {
        check.projector_rms_px = std::numbers::sqrt2 * scan.resection->rms_before_px;  // said per axis there
        check.projector_after_px = std::numbers::sqrt2 * scan.resection->rms_after_px;
        RigCalibration placed = rig;
        placed.projector = scan.resection->projector;
        check.bent = bent_residuals(scan.raw, placed);
        check.moved_mm = scan.resection->moved_mm;
        check.turned = scan.resection->turned;
        check.light_off_mm = check.projector_rms_px * mm_per_px(scan.raw, rig.projector);
    }
    check.reason = unfit(scan, limits);
    if (!check.reason.empty())
        check.remedy = "Show the full sequence of `planlight patterns`.";
    else if (moved && check.points >= limits.min_points)
        decide_by_state(check, scan.rig);
    else
        decide(check, scan.resection.has_value(), scan.rig, limits);
    return check;
}

std::vector<DriftTrend> drift_trends(const std::vector<EarlierCheck>& checks, const DriftLimits& limits) {
    std::vector<DriftTrend> trends;
    const auto add = [&](const char* what, double EarlierCheck::*value, double limit) {
        std::vector<EarlierCheck> known;
        std::copy_if(checks.begin(), checks.end(), std::back_inserter(known),
                     [&](const auto& c) { return c.*value > 0; });
        if (known.size() < 4) return;
        const auto [first, last] =
            std::minmax_element(known.begin(), known.end(), [](const auto& a, const auto& b) { return a.day < b.day; });
        if (last->day - first->day < 2) return;
        const Line line = fit_line(known, value);
        if (line.slope > 2 * line.slope_sigma && line.slope > 1e-4)
            trends.push_back({what, line.slope, std::max(0.0, (limit - line.at_last) / line.slope)});
    };
    add("epipolar error", &EarlierCheck::epipolar_px, limits.epipolar_px);
    add("projector", &EarlierCheck::projector_rms_px, limits.projector_px);
    return trends;
}

}  // namespace planlight
