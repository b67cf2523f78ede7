#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/belonging.h"
#include "app/commands/capture_conversion.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/device_check.h"
#include "app/commands/marker_option.h"
#include "app/commands/rig_words.h"
#include "app/console.h"
#include "app/json_text.h"
#include "planning_io/case/cloud_rig.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "registration/calibration/check_drift.h"
#include "registration/scan/check/camera_gamma.h"
#include "registration/scan/clean/surface_triangles.h"
#include "registration/scan/decode/merge_exposures.h"
#include "registration/scan/decode/second_harmonic.h"
#include "registration/tracking/markers_in_scan.h"

namespace planlight {
namespace {

struct ScanOptions {
    Path capture, rig, out, raw_out;
    Path surface_out;             ///< the same points with triangles; empty: not wanted
    std::vector<Path> exposures;  ///< further captures of the same pose
    std::string markers = "8/16";
    double max_movement_mm = 0.15;  ///< of the patient during the scan
    bool accept_movement = false, allow_missing = false, json = false;
};

/// Null of a camera that is not there.
nlohmann::json counts(const DecodedView& view) {
    if (view.width <= 1) return nullptr;
    return {
        {"decoded", view.decoded}, {"dark", view.dark}, {"saturated", view.saturated}, {"uncertain", view.uncertain}};
}

std::string devices_of(const ScanResult& scan, const RigCalibration& rig) {
    if (!present(rig.projector)) return "two cameras";
    return scan.right.width > 1 ? "two cameras and the projector" : "one camera and the projector";
}

/// 0 is not known.
nlohmann::json or_null(double value) {
    return value > 0 ? nlohmann::json(value) : nlohmann::json();
}

/// How far the light lies off where both cameras see it, median; null where no point is seen by both.
nlohmann::json offset_of(const Triangulation& raw) {
    if (raw.by_cameras.empty()) return nullptr;
    return {raw.projector_offset_px.x(), raw.projector_offset_px.y()};
}

/// Where the scan found the projector; null where it could not tell.
nlohmann::json projector_of(const ScanResult& scan) {
    if (!scan.resection) return nullptr;
    return {{"rms_before_px", scan.resection->rms_before_px},
            {"rms_after_px", scan.resection->rms_after_px},
            {"moved_mm", scan.resection->moved_mm},
            {"turned_deg", scan.resection->turned * 180 / std::numbers::pi},
            {"used", scan.resection_used}};
}

void warn_of(const ScanResult& scan, const RigCalibration& rig) {
    if (scan.left.row.empty() && scan.right.width <= 1)
        warn(
            "one camera and the projector's columns alone: each point is where a line of sight meets a plane of light, "
            "and nothing "
            "checks it; a wrong rig file or light that came another way shows in nothing");
    if (scan.code_step_px > 0)
        warn(fmt::format(
            "the light was read to {:g} projector pixels only: the fringes, or the finest bits that count them, are "
            "not in the capture or not resolved by the cameras; the cloud is coarser",
            scan.code_step_px));
    if (scan.rig.moved()) warn(fmt::format("{}. {}", scan.rig.sentence, scan.rig.remedy));
    if (scan.code_step_px > 0 || scan.rig.moved()) return;  // cells are no measure of the cameras
    const DriftCheck drift = check_drift(scan, rig);
    if (drift.verdict == DriftCheck::Verdict::cameras_moved)
        warn(fmt::format("{}; the cloud may be off by millimetres and nothing in it shows where. {}", drift.reason,
                         drift.remedy));
}

/// Three shifts do not show what the gamma of projector and camera does to them.
void warn_of_three_shifts(const ScanCapture& capture) {
    constexpr double kLinear = 0.03, kMost = 0.3;
    const char* remedy = "Show 4 shifts or more (usual are 5 or 8), or light without a gamma.";
    for (const auto* frames : {&capture.left, &capture.right}) {
        if (frames->empty() || !capture.partial.empty()) continue;
        const auto share = largest_second_harmonic(*frames, capture.stripes);
        if (!share)
            return warn(fmt::format(
                "fringes of three shifts, and too little is lit to measure what a gamma does to them: the light may be "
                "read wrongly by a twentieth of a period ({:.1f} projector pixels). {}",
                capture.stripes.phase_period_px / 20, remedy));
        if (std::abs(*share) > kMost)
            return warn(fmt::format(
                "fringes of three shifts under a strong gamma (second harmonic {:.0f} % of the fringe): it is measured "
                "and taken out, but at the crests nothing is left to read, and the cloud has gaps or is rough there. "
                "{}",
                100 * *share, remedy));
        if (std::abs(*share) > kLinear)
            return warn(fmt::format(
                "fringes of three shifts under a gamma (second harmonic {:.0f} % of the fringe): it is measured and "
                "taken out, but the cloud is noisier than by more shifts. {}",
                100 * *share, remedy));
    }
}

/// Light that was read, and whose code is not smooth round the pixels.
void warn_of_ragged(const ScanResult& scan) {
    const std::size_t placed = scan.raw.cloud.size() + scan.raw.disagree + scan.raw.outside_volume;
    if (scan.raw.ragged <= placed + scan.raw.no_partner) return;
    warn(fmt::format(
        "more than half of the places that the light was read at are left out, because the code is not smooth round "
        "them ({} ragged, {} placed): the pictures are too noisy or blurred for these patterns, or the stripes are "
        "finer than a few camera pixels. Give more light, focus projector and cameras, or show wider stripes.",
        scan.raw.ragged, placed));
}

/// By rig.json, as `check` says it.
double epipolar_of(const ScanResult& scan) {
    return scan.epipolar_as_calibrated_px > 0 ? scan.epipolar_as_calibrated_px : usual_epipolar_px(scan.raw);
}

std::string said_of_cameras(const ScanResult& scan) {
    const double off_px = epipolar_of(scan);
    return off_px > 0 ? fmt::format("; epipolar error {:.2f} px", off_px) : std::string();
}

nlohmann::json json_of(const ScanMovement& movement) {
    if (movement.by == ScanMovement::By::nothing) return nullptr;
    return {{"by", movement.by == ScanMovement::By::markers ? "markers" : "pictures"},
            {"moved_mm", movement.way_mm()},
            {"seen_mm", movement.moved_mm},
            {"unseen_mm",
             movement.by == ScanMovement::By::pictures ? nlohmann::json(movement.unseen_mm()) : nlohmann::json()},
            {"turned_deg", movement.turned * 180 / std::numbers::pi},
            {"from", movement.from},
            {"to", movement.to},
            {"light_change",
             movement.by == ScanMovement::By::pictures ? nlohmann::json(movement.light_change) : nlohmann::json()},
            {"moments", movement.moments},
            {"markers", movement.markers}};
}

/// Lamps that are not equally bright in all pictures are taken out as far as they are even; what is left can look like
/// a movement.
std::string said_of_light(const ScanMovement& movement) {
    constexpr double kSteady = 0.03;
    if (movement.by != ScanMovement::By::pictures || movement.light_change < kSteady) return {};
    constexpr double kMeasured = 0.5;  // of more only that it is much is known
    const std::string by =
        movement.light_change > kMeasured ? "more than half" : fmt::format("{:.0f} %", 100 * movement.light_change);
    return fmt::format("; the light changed by {} meanwhile, which can look like a movement", by);
}

/// A picture that the projector draws larger, or askew, has stripes that do not add up to even light, which looks like
/// a movement of skin in the pictures.
std::string said_of_rig(const ScanMovement& movement, const RigState& rig) {
    if (movement.by != ScanMovement::By::pictures || !rig.moved()) return {};
    return fmt::format(
        "If the head lay still, this is the cause: {}. See that no keystone correction and no scaling of the picture "
        "is "
        "on, else calibrate the rig again. ",
        rig.sentence);
}

void judge_movement(const ScanMovement& movement, const RigState& rig, const ScanOptions& options) {
    if (movement.by == ScanMovement::By::nothing) {
        warn(
            "whether the patient moved during the scan is not known: too little is seen under light that is even and "
            "alike in all pictures");
        return;
    }
    if (movement.way_mm() <= options.max_movement_mm) {
        if (movement.by == ScanMovement::By::markers && !movement.throughout)
            warn(
                fmt::format("whether the patient moved is known of a part of the scan only: the markers are seen in {} "
                            "of its pictures under even light",
                            movement.moments));
        if (movement.unseen_mm() > options.max_movement_mm)
            warn(
                fmt::format("whether the patient moved during the scan is known to {:.1f} mm only: the skin shows "
                            "little that could be "
                            "seen to move (markers would show it)",
                            movement.unseen_mm()));
        return;
    }
    const bool by_markers = movement.by == ScanMovement::By::markers;
    const std::string problem = fmt::format(
        "the patient moved {}{:.2f} mm during the scan (between {} and {}, by {}); {:.2f} mm is the limit{}{}",
        by_markers ? "" : "about ", movement.way_mm(), movement.from, movement.to,
        by_markers ? "the markers"
                   : fmt::format("the skin in the pictures: {:.2f} mm across the line of sight, twice that in all",
                                 movement.moved_mm),
        options.max_movement_mm, said_of_gamma(movement.camera_gamma), said_of_light(movement));
    if (!options.accept_movement)
        throw CheckFailedError(
            problem, said_of_rig(movement, rig) +
                         (said_of_light(movement).empty()
                              ? "Scan again, or take the cloud as it is with --accept-movement. If it comes back on a "
                                "head that lies "
                                "still, switch off what the cameras do to their pictures (sharpening, noise reduction)."
                              : "Let nobody switch or shade a lamp, switch off what camera and projector do "
                                "to their pictures by themselves (sharpening, contrast, a lamp that "
                                "follows the picture), take an exposure of whole cycles of "
                                "the lamps' flicker, and scan again; or take the cloud as it is with "
                                "--accept-movement."));
    warn(problem);
}

/// Of the capture in which the patient moved most. One that is exposed for the darkest or the brightest places shows
/// too little to tell by; of the first that is said.
ScanMovement judged_movement(const std::vector<ScanCapture>& captures, const ScanResult& scan,
                             const RigCalibration& rig, const ScanOptions& options) {
    ScanMovement most;
    for (const ScanCapture& capture : captures) {
        const bool first = &capture == &captures.front();
        const ScanMovement movement = movement_in_scan(capture, rig, scan.clean.kept,
                                                       tracking_settings_for(marker_design_named(options.markers)));
        if (first || movement.way_mm() > options.max_movement_mm) judge_movement(movement, scan.rig, options);
        if (first || movement.way_mm() > most.way_mm()) most = movement;
    }
    return most;
}

/// Where most of what was read lies off the rays of the rig file, the rest lies on them by chance.
void judge_fit(const ScanResult& scan, const RigCalibration& rig) {
    constexpr double kMostOff = 0.75;
    const double off = static_cast<double>(scan.raw.disagree), on = static_cast<double>(scan.raw.cloud.size());
    if (off + on > 0 && off > kMostOff * (off + on))
        throw CheckFailedError(
            fmt::format("the capture does not fit the rig file: {} of {} places that the light was read at lie off the "
                        "rays of {}",
                        scan.raw.disagree, scan.raw.disagree + scan.raw.cloud.size(), devices_of(scan, rig)),
            "Use the rig.json of this rig; check that left and right are not swapped and no picture is mirrored; if "
            "the rig was "
            "moved, calibrate it again.");
    if (scan.clean.kept.empty() && scan.left.saturated > scan.left.decoded + scan.left.uncertain)
        throw CheckFailedError(
            fmt::format(
                "no skin was found in the capture: the left picture is saturated at {} pixels and decoded at {}",
                scan.left.saturated, scan.left.decoded),
            "Shorten the exposure, close the aperture or dim lamps and projector, and capture again.");
    if (scan.clean.kept.empty())
        throw CheckFailedError(
            fmt::format("no skin was found in the capture ({} of {} pixels of the left picture decoded)",
                        scan.left.decoded, scan.left.width * scan.left.height),
            "Check that the projector lights the patient and that rig.json belongs to this capture.");
}

int run_scan(const ScanOptions& options) {
    marker_design_named(options.markers);  // before long work
    for (const Path& file : {options.out, options.raw_out, options.surface_out})
        if (!file.empty()) check_can_write(file);  // of all, before one is written
    const RigCalibration rig = read_partial_rig(options.rig);
    std::vector<ScanCapture> captures;
    std::vector<Path> folders{options.capture};
    folders.insert(folders.end(), options.exposures.begin(), options.exposures.end());
    ProgressBar bar;
    const ReadCapture how{options.allow_missing, [&](double share) { bar.show("pictures", share); },
                          [](const std::string& what) { warn(what); }};
    for (const Path& folder : folders) {
        captures.push_back(scan_capture_from(read_capture_of(rig, folder, how), folder));
        check_sizes(captures.back(), rig, folder);
        if (captures.back().stripes.rows != captures.front().stripes.rows ||
            captures.back().right.empty() != captures.front().right.empty())
            throw InputError(folder, "has other directions or cameras than the first capture",
                             "Give exposures of one pose with one sequence.");
    }
    const ScanCapture& capture = captures.front();
    const ScanResult scan = scan_from_exposures(captures, rig);
    judge_fit(scan, rig);
    // Before the devices, which the light on moving skin accuses wrongly.
    const ScanMovement movement = judged_movement(captures, scan, scan.rig.rig.whole() ? scan.rig.rig : rig, options);
    warn_of(scan, rig);
    for (const ScanCapture& one : captures) warn_of_three_shifts(one);
    warn_of_ragged(scan);
    RigState state = named_rig_state(scan, rig, capture);
    if (movement.way_mm() > options.max_movement_mm) state.accepted_movement_mm = movement.way_mm();
    const std::vector<std::string> names = comments_of(state);
    write_cloud(scan.clean.kept, options.out, {}, names);
    if (!options.raw_out.empty()) write_cloud(scan.raw.cloud, options.raw_out, {}, names);
    std::vector<std::array<std::int32_t, 3>> triangles;
    if (!options.surface_out.empty()) {
        triangles = surface_triangles(scan.clean.kept);
        write_cloud(scan.clean.kept, options.surface_out, triangles, names);
    }
    if (options.json) {
        const nlohmann::json result = {
            {"points", scan.clean.kept.size()},
            {"raw_points", scan.raw.cloud.size()},
            {"triangles", options.surface_out.empty() ? nlohmann::json() : nlohmann::json(triangles.size())},
            {"left", counts(scan.left)},
            {"right", counts(scan.right)},
            {"three_view", scan.raw.three_view},
            {"two_view", scan.raw.two_view},
            {"removed",
             {{"no_partner", scan.raw.no_partner},
              {"disagree", scan.raw.disagree},
              {"ragged", scan.raw.ragged},
              {"outside_volume", scan.raw.outside_volume},
              {"jump", scan.clean.jump},
              {"grazing", scan.clean.grazing},
              {"small_piece", scan.clean.small_piece},
              {"lonely", scan.clean.lonely},
              {"thinned", scan.clean.thinned}}},
            {"devices", devices_of(scan, rig)},
            {"code_step_px", scan.code_step_px},
            {"epipolar_px", or_null(epipolar_of(scan))},
            {"epipolar_rms_px", or_null(scan.raw.epipolar_rms_px)},
            {"projector_offset_px", offset_of(scan.raw)},
            {"projector", projector_of(scan)},
            {"rig", rig_state_json(scan.rig)},
            {"movement", json_of(movement)},
            {"seconds",
             {{"sequence", scan.sequence_s},
              {"decode", scan.decode_s},
              {"triangulate", scan.triangulate_s},
              {"outliers", scan.outliers_s}}}};
        std::cout << json_text(result) << '\n';
    } else {
        fmt::print(
            "{} points by {} in {} (raw {}; off the rays {}, ragged {}, jumps {}, grazing {}, small pieces {}, lonely "
            "{}){}.\n",
            scan.clean.kept.size(), devices_of(scan, rig), options.out.string(), scan.raw.cloud.size(),
            scan.raw.disagree, scan.raw.ragged, scan.clean.jump, scan.clean.grazing, scan.clean.small_piece,
            scan.clean.lonely, said_of_cameras(scan));
        if (!options.surface_out.empty())
            fmt::print("{} triangles over them in {}.\n", triangles.size(), options.surface_out.string());
    }
    return 0;
}

}  // namespace

Run add_scan(CLI::App& app) {
    const auto options = std::make_shared<ScanOptions>();
    ScanOptions& o = *options;
    auto* sub = add_command(app, "scan", "Captured stripe pictures -> cloud of skin points in rig",
                            "scan room/capture --rig room/rig.json --out cloud.ply");
    sub->add_option("capture", o.capture, "Capture folder")->required();
    sub->add_option("--exposure", o.exposures,
                    "Another capture of the same pose, darker or brighter; may be said again");
    sub->add_option("--rig", o.rig, "rig.json")->required();
    sub->add_option("--out", o.out, "Clean cloud (.ply)")->required();
    sub->add_option("--raw", o.raw_out, "Also the cloud before the outliers were removed (.ply)");
    sub->add_option("--surface", o.surface_out,
                    "Also the scan as a triangulated surface (.ply: the same points, with faces)");
    markers_option(sub, o.markers);
    sub->add_option("--max-movement-mm", o.max_movement_mm, "Of the patient during the scan; more is refused (exit 6)")
        ->capture_default_str()
        ->check(CLI::Range(0.01, 100.0));
    sub->add_flag("--accept-movement", o.accept_movement,
                  "Write the cloud of a patient who moved; only warn (a match with it is asked about)");
    sub->add_flag("--allow-missing", o.allow_missing,
                  "Where pictures are missing use what can be read without them, coarser; else that is refused");
    json_flag(sub, o.json);
    return [options] { return run_scan(*options); };
}

}  // namespace planlight
