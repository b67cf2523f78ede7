#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/belonging.h"
#include "app/commands/capture_conversion.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/device_check.h"
#include "app/commands/marker_option.h"
#include "app/console.h"
#include "app/json_text.h"
#include "app/without_numbers.h"
#include "planning_io/case/frames_folder.h"
#include "planning_io/case/poses_file.h"
#include "planning_io/case/registration_file.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/header_text.h"
#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"
#include "registration/devices/colour_mosaic.h"
#include "registration/devices/repeated_picture.h"
#include "registration/tracking/camera_lag.h"
#include "registration/tracking/track_patient.h"
#include "registration/tracking/why_lost.h"

namespace planlight {
namespace {

struct TrackOptions {
    Path frames, rig, capture, registration, out;
    std::string markers = "8/16";
    bool json = false;
};

/// The rig as the scan found it, and the picture that the poses begin at.
struct Reference {
    PosesOrigin origin;
    StereoFrame frame;
    std::optional<StereoFrame> of_scan;  ///< another picture of the same scan, under the room's light alone
};

void judge_rig(const RigState& state) {
    if (state.verdict == RigState::Verdict::not_trusted)
        throw CheckFailedError("the rig cannot be trusted: " + state.sentence, state.remedy);
    if (state.moved()) warn(fmt::format("{}. {}", state.sentence, state.remedy));
}

Reference reference_of(const TrackOptions& options, const RigCalibration& rig, const std::vector<StereoFrame>& frames) {
    Reference reference{{name_of(rig), {}, rig}, frames.front(), {}};
    std::optional<RigState> found;
    if (!options.capture.empty()) {
        const ScanCapture capture = scan_capture_from(read_capture_of(rig, options.capture), options.capture);
        if (capture.right.empty())
            throw InputError(options.capture, "has the left camera's pictures only",
                             "Markers need both cameras: capture with both.");
        reference.frame = {capture.left.front(), capture.right.front(), capture.began, Instant{}, 0};
        if (capture.left.size() > 1 && capture.right.size() > 1 && capture.partial.empty())
            reference.of_scan = StereoFrame{capture.left[1], capture.right[1], capture.began, Instant{}, 0};
        reference.origin.capture_hash = hash_of(capture);
        ScanSettings settings;
        settings.check_sequence = false;  // `scan` has judged it
        if (options.registration.empty()) found = scan_from_capture(capture, rig, settings).rig;
    }
    if (!options.registration.empty()) {
        std::vector<std::string> unknown;
        const RegistrationResult match = read_registration(options.registration);
        check_rig(match, rig, options.registration, options.rig, unknown);
        for (const std::string& what : unknown) warn(what);
        if (!options.capture.empty() && match.rig && !match.rig->capture_hash.empty() &&
            match.rig->capture_hash != reference.origin.capture_hash)
            throw InputError(options.registration, "is the match of another scan than " + options.capture.string(),
                             "Name the capture that was scanned and matched.");
        found = match.rig;
    }
    if (!found) return reference;
    judge_rig(*found);
    if (found->rig.whole()) reference.origin.rig = found->rig;
    return reference;
}

StereoFrame with_exchanged_pictures(StereoFrame frame) {
    std::swap(frame.left, frame.right);
    return frame;
}

/// The disc's diameter with which most of the markers meet in space, though not with the one that was said, mm.
std::optional<double> other_size_mm(const StereoFrame& frame, const RigCalibration& rig, MarkerDesign design,
                                    std::size_t more_than) {
    const double ratio = design.sticker_diameter_mm / design.disc_diameter_mm;
    std::optional<double> best_mm;
    for (const double mm : {4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 18.0, 22.0}) {
        PatientTracker other(rig, tracking_settings_for({mm, ratio * mm}));
        const std::size_t met = other.set_reference(frame).size();
        if (met <= more_than) continue;
        more_than = met;
        best_mm = mm;
    }
    return best_mm;
}

/// Throws CheckFailedError with what can be told of the cause.
void judge_reference(const PatientTracker& tracker, const StereoFrame& frame, const RigCalibration& rig,
                     const MarkerDesign& design) {
    constexpr std::size_t kFew = 3, kSurelyPasted = 4;
    const std::size_t markers = tracker.markers().size(), left = tracker.seen_left().size(),
                      right = tracker.seen_right().size();
    if (markers >= kFew && 2 * markers >= std::min(left, right)) return;
    if (frame.left.width == frame.right.width && frame.left.height == frame.right.height) {
        PatientTracker other(rig, tracking_settings_for(design));
        if (const std::size_t exchanged = other.set_reference(with_exchanged_pictures(frame)).size();
            exchanged > std::max(markers, kFew))
            throw CheckFailedError(
                fmt::format("the left camera's picture seems to be the right one's: {} markers meet when the two are "
                            "exchanged, {} as they are",
                            exchanged, markers),
                "Exchange the folders of left and right, in the frames and in the capture.");
    }
    const std::string met = fmt::format(
        "{} of {} discs in the left and {} in the right reference picture meet in space", markers, left, right);
    if (const auto mm = other_size_mm(frame, rig, design, std::max(markers, kFew)))
        throw CheckFailedError(fmt::format("only {}, as discs of {:g} mm; as discs of some {:g} mm more of them do",
                                           met, design.disc_diameter_mm, *mm),
                               "Say how large the markers are: --markers DISC/STICKER, mm, as 12/24.");
    if (std::min(left, right) >= kSurelyPasted) {
        constexpr const char* kRemedy =
            "See that at least five of the markers are seen by both cameras, and give the rig.json that these cameras "
            "were calibrated with; if a camera was moved since, calibrate again.";
        const std::string cause = met + ": each camera sees other discs, or the rig is not that of these pictures";
        if (markers < kFew) throw CheckFailedError("only " + cause, kRemedy);
        return warn(fmt::format("Only {}. {}", cause, kRemedy));
    }
    throw CheckFailedError(fmt::format("only {} markers were found by both cameras in the reference picture", markers),
                           "Paste at least five markers where both cameras see them.");
}

/// Throws CheckFailedError with what can be told of the cause: no frame has a pose.
[[noreturn]] void refuse_lost(const PatientTracker& tracker, const StereoFrame& frame) {
    using Cause = WhyLost::Cause;
    const WhyLost why = why_lost(tracker, frame);
    switch (why.cause) {
        case Cause::exchanged:
            throw CheckFailedError("in the frames left and right camera are exchanged against the reference picture",
                                   "Exchange the folders of left and right in the frames.");
        case Cause::turned:
            throw CheckFailedError("the frames are turned by 180 degrees against the reference picture",
                                   "Turn the pictures of both cameras back, or switch the turn off in the cameras' "
                                   "settings and record again.");
        case Cause::mirrored:
            throw CheckFailedError("the frames are mirrored against the reference picture",
                                   "Mirror the pictures of both cameras back, or switch the flip off in the cameras' "
                                   "settings and record again.");
        case Cause::camera_moved:
            throw CheckFailedError(
                fmt::format("each camera sees as many discs as the reference picture has markers ({}), but they do not "
                            "meet in space: a camera moved since the scan",
                            tracker.markers().size()),
                "Scan again; if the scan is refused as well, calibrate again. See also that the rig.json is that of "
                "these cameras.");
        case Cause::fewer_seen:
            throw CheckFailedError(
                fmt::format("the frames show fewer discs ({} in the left picture, {} in the right) than the reference "
                            "picture has markers ({}): they are blurred, too dark or too bright, or the markers are "
                            "covered",
                            why.left, why.right, tracker.markers().size()),
                "Expose for a shorter time where the head moves, with more light; see that nothing covers the "
                "markers.");
        case Cause::rearranged:
            break;
    }
    throw CheckFailedError(
        fmt::format("in no frame were the {} markers of the reference picture found where they stand together",
                    tracker.markers().size()),
        "Give the frames of this patient, with the markers as they were pasted at the scan, and the rig.json of their "
        "cameras; if a camera was moved since, scan again.");
}

/// Throws CheckFailedError where one camera's pictures are older than the other's in all frames; takes the poses out of
/// frames in which one picture is of another moment, and says so.
void judge_moments(const CameraLag& cameras, std::vector<TrackedPose>& poses) {
    constexpr double kLeast_s = 0.003, kSigmas = 5;
    if (const CameraLag::Lag lag = cameras.lag(); lag.known) {
        const double s = std::abs(lag.right_later_s);
        if (s > kLeast_s && s > kSigmas * lag.sigma_s)
            throw CheckFailedError(
                fmt::format("the {} camera's pictures are {:.0f} ms older than the other's: while the head moves, its "
                            "markers do not meet in space",
                            lag.right_later_s < 0 ? "right" : "left", 1e3 * s),
                "Expose both cameras together, and pair their pictures by the times of exposure.");
    }
    const std::vector<std::size_t> odd = cameras.odd_frames();
    if (odd.empty()) return;
    for (const std::size_t frame : odd) {
        poses[frame].rig_from_patient.reset();
        poses[frame].reason = "left and right picture are not of the same moment";
    }
    warn(fmt::format("{} without a pose: left and right picture are not of the same moment (the first: number {})",
                     counted(static_cast<long long>(odd.size()), "frame"), odd.front()));
}

/// Frames without a pose for one reason.
struct WithoutPose {
    std::string reason;  ///< of the first of them, with its numbers
    std::size_t first = 0, frames = 0;
};

/// How well the markers fit both cameras in another picture of the scan, px; empty where it has none that tells.
std::optional<double> residual_at_scan_px(const Reference& reference, const MarkerDesign& design) {
    if (!reference.of_scan) return std::nullopt;
    PatientTracker tracker(reference.origin.rig, tracking_settings_for(design));
    tracker.set_reference(reference.frame);
    const TrackedPose pose = tracker.update(*reference.of_scan);
    if (!pose.rig_from_patient) return std::nullopt;
    return pose.residual_px;
}

/// A camera that was knocked since the scan leaves poses that agree, and are wrong: the markers fit it a little worse,
/// in every frame alike.
void warn_of_worse_fit(const std::vector<TrackedPose>& poses, const std::optional<double>& at_scan_px) {
    constexpr double kWorse = 1.5, kNoise_px = 0.01;
    if (!at_scan_px) return;
    std::vector<double> residuals;
    for (const TrackedPose& pose : poses)
        if (pose.rig_from_patient) residuals.push_back(pose.residual_px);
    const double usual_px = median(std::move(residuals));
    if (usual_px > kWorse * *at_scan_px + kNoise_px)
        warn(fmt::format(
            "the markers fit the cameras worse than in the scan ({:.2f} px against {:.2f}): a camera was moved since, "
            "or "
            "the skin between the markers was; then the poses are farther off than they say. Look at the light on "
            "landmarks, or scan again.",
            usual_px, *at_scan_px));
}

/// A reason whose numbers alone differ is one; in the order in which they come.
std::vector<WithoutPose> without_pose(const std::vector<TrackedPose>& poses) {
    std::vector<WithoutPose> found;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (poses[i].rig_from_patient) continue;
        const auto same = std::find_if(found.begin(), found.end(), [&](const WithoutPose& w) {
            return without_numbers(w.reason) == without_numbers(poses[i].reason);
        });
        if (same == found.end())
            found.push_back({poses[i].reason, i, 1});
        else
            ++same->frames;
    }
    return found;
}

/// Says whether a camera's pictures came again under new times: poses by them are of an earlier moment.
std::array<std::size_t, 2> warn_of_repeats(const std::vector<StereoFrame>& frames) {
    std::array<std::size_t, 2> repeats{};
    RepeatedPicture left, right;
    for (const StereoFrame& frame : frames) {
        repeats[0] += left.is(frame.left) ? 1 : 0;
        repeats[1] += right.is(frame.right) ? 1 : 0;
    }
    for (const std::size_t side : {0, 1})
        if (repeats[side] > 0)
            warn(
                fmt::format("{} of the {} camera's pictures are the one before, bit for bit: no camera sends one "
                            "twice. If it hung, "
                            "their poses are those of an earlier moment. Look at its driver and its recording.",
                            repeats[side], side == 0 ? "left" : "right"));
    return repeats;
}

int run_track(const TrackOptions& options) {
    const RigCalibration rig = read_rig(options.rig);
    const auto frames = read_frames(options.frames);
    if (frames.empty())
        throw InputError(options.frames, "there is no frame in the folder", "Record at least one frame.");
    const MarkerDesign design = marker_design_named(options.markers);
    const Reference reference = reference_of(options, rig, frames);
    for (const StereoFrame* frame : {&frames.front(), &reference.frame}) {
        refuse_colour_mosaic(frame->left, "left");
        refuse_colour_mosaic(frame->right, "right");
    }
    PatientTracker tracker(reference.origin.rig, tracking_settings_for(design));
    const auto markers = tracker.set_reference(reference.frame).size();
    judge_reference(tracker, reference.frame, reference.origin.rig, design);
    std::vector<TrackedPose> poses;
    CameraLag cameras(reference.origin.rig);
    ProgressBar bar;
    for (const auto& frame : frames) {
        poses.push_back(tracker.update(frame));
        cameras.add(tracker, frame.at);
        bar.show("track", static_cast<double>(poses.size()) / static_cast<double>(frames.size()));
    }
    judge_moments(cameras, poses);
    const auto found =
        std::count_if(poses.begin(), poses.end(), [](const auto& p) { return p.rig_from_patient.has_value(); });
    if (found == 0) refuse_lost(tracker, frames.front());
    warn_of_worse_fit(poses, residual_at_scan_px(reference, design));
    const std::array<std::size_t, 2> repeats = warn_of_repeats(frames);
    const std::vector<WithoutPose> lost = without_pose(poses);
    write_poses(poses, options.out, reference.origin);
    double worst_px = 0;
    for (const auto& pose : poses) worst_px = std::max(worst_px, pose.residual_px);
    if (options.json) {
        nlohmann::json reasons = nlohmann::json::array();
        for (const WithoutPose& w : lost)
            reasons.push_back({{"reason", w.reason}, {"first", w.first}, {"frames", w.frames}});
        const nlohmann::json result = {
            {"frames", frames.size()}, {"poses", found},
            {"markers", markers},      {"worst_residual_px", worst_px},
            {"without_pose", reasons}, {"repeated_pictures", {{"left", repeats[0]}, {"right", repeats[1]}}}};
        std::cout << json_text(result) << '\n';
    } else {
        fmt::print("{} of {} frames have a pose ({} markers, worst residual {:.3f} px).\n", found, frames.size(),
                   markers, worst_px);
        for (const WithoutPose& w : lost)
            fmt::print(
                "{} without a pose: {}{}.\n", counted(static_cast<long long>(w.frames), "frame"), w.reason,
                w.frames > 1 ? fmt::format(" (the first: number {})", w.first) : fmt::format(" (number {})", w.first));
    }
    return 0;
}

}  // namespace

Run add_track(CLI::App& app) {
    const auto options = std::make_shared<TrackOptions>();
    TrackOptions& o = *options;
    auto* sub = add_command(app, "track", "Recorded frames -> poses of the patient (T_cur)",
                            "track room/frames --rig room/rig.json --capture room/capture --out poses.json");
    sub->add_option("frames", o.frames, "Folder of recorded frames")->required();
    sub->add_option("--rig", o.rig, "rig.json")->required();
    sub->add_option(
        "--capture", o.capture,
        "Capture folder of the scan: its white picture holds the reference markers (default: the first frame)");
    sub->add_option("--registration", o.registration,
                    "The match to follow: its rig, as the scan found it, is used (default: found again in --capture)");
    markers_option(sub, o.markers);
    sub->add_option("--out", o.out, "poses.json to write")->required();
    json_flag(sub, o.json);
    return [options] { return run_track(*options); };
}

}  // namespace planlight
