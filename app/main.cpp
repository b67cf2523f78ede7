#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/console.h"
#include "planning_io/types/error.h"

namespace {

using namespace planlight;

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 2 usage, 3 input refused, 4 file damaged or of another version, 5 device, 6 a check failed, 7 disk,\n"
    "70 a fault of ours.";

CLI::App* command(CLI::App& app, const std::string& name, const std::string& what, const std::string& example) {
    CLI::App* sub = app.add_subcommand(name, what);
    sub->footer("Example:\n  planlight " + example);
    return sub;
}

void json_flag(CLI::App* sub, bool& json) { sub->add_flag("--json", json, "Print the result as JSON on standard output"); }

CLI::Option* preset_option(CLI::App* sub, std::string& preset) {
    return sub
        ->add_option("--preset", preset,
                     "Simulated room: modern (1920x1080, two 1920x1200) or paper (800x600, two 744x576)")
        ->check(CLI::IsMember({"modern", "paper"}))
        ->capture_default_str();
}

void plan_frame_options(CLI::App* sub, std::string& frame, std::string& accept_frame) {
    sub->add_option("--frame", frame, "Coordinate system of plan files that do not say their own")
        ->check(CLI::IsMember({"LPS", "RAS"}));
    sub->add_option("--accept-frame", accept_frame, "DICOM frame of reference (UID) that is known to be the volume's");
}

void add_plan(CLI::App& app, PlanOptions& o) {
    auto* sub = command(app, "plan", "Plan files -> checked, listed, converted",
                        "plan trajectories.csv --frame RAS --case case --out plan.mrk.json");
    sub->add_option(
           "files", o.files,
           "3D Slicer markups (.mrk.json, .fcsv), RTSTRUCT (.dcm), trajectories (.csv, .tsv), lines (.vtp, .vtk, .ply, .obj)")
        ->required();
    sub->add_option("--case", o.case_folder, "Check against this case's skin");
    sub->add_option("--volume", o.volume, "Check against this volume's box and frame of reference");
    sub->add_option("--series", o.series_uid, "UID of the DICOM series, where the folder holds several");
    plan_frame_options(sub, o.frame, o.accept_frame);
    sub->add_option("--out", o.out, "Write the whole plan: .mrk.json, .vtp, or .dcm (RTSTRUCT)");
    json_flag(sub, o.json);
}

void add_prepare(CLI::App& app, PrepareOptions& o) {
    auto* sub = command(app, "prepare", "CT or MR volume and plan -> case folder (skin, LUT, plan, checksums)",
                        "prepare Cranium.inv3 --plan frontal_defect.mrk.json --out case");
    sub->add_option("volume", o.volume, "DICOM folder or file, NIfTI, NRRD, MetaImage, or InVesalius project (.inv3)")
        ->required();
    sub->add_option("--plan", o.plan,
                    "Plan file, or a folder of them: .mrk.json, .fcsv, RTSTRUCT, tables, lines (see planning_io/README.md)")
        ->required();
    plan_frame_options(sub, o.frame, o.accept_frame);
    sub->add_option(
        "--surface", o.surface,
        "Surface to project on instead of the skin: bone, or any other (.stl, .ply, .obj, .vtp, .vtk, DICOM SEG or RTSTRUCT)");
    sub->add_option("--surface-frame", o.surface_frame, "Coordinate system of a surface that does not say its own")
        ->check(CLI::IsMember({"LPS", "RAS"}));
    sub->add_option("--segment", o.segment, "Which segment or ROI of a DICOM SEG or RTSTRUCT, by its name");
    sub->add_option("--out", o.out, "Case folder to write")->required();
    sub->add_option("--series", o.series_uid, "UID or number of the DICOM series, where the folder holds several");
    sub->add_flag("--anonymous", o.anonymous, "Leave UIDs and file names of the volume out of the case folder");
    sub->add_option("--threshold", o.threshold, "Skin threshold, HU (default: found from the histogram)");
    sub->add_option("--voxel-mm", o.voxel_mm, "Edge of the LUT's cubic voxels")
        ->capture_default_str()
        ->check(CLI::Range(0.25, 10.0));
    sub->add_flag("--replace", o.replace, "Replace an existing case folder");
    sub->add_flag("--preview", o.preview, "Open the operator window on the result");
    json_flag(sub, o.json);
}

void add_patterns(CLI::App& app, PatternsOptions& o) {
    auto* sub = command(app, "patterns", "Write the coded-light sequence as pictures to project",
                        "patterns --width 1920 --height 1080 --out patterns");
    sub->add_option("--width", o.width, "Of the projector, pixels")->capture_default_str()->check(CLI::Range(64, 8192));
    sub->add_option("--height", o.height, "Of the projector, pixels")->capture_default_str()->check(CLI::Range(64, 8192));
    sub->add_option("--phase-steps", o.phase_steps, "Shifts a direction")->capture_default_str()->check(CLI::Range(3, 32));
    sub->add_option("--set", o.set,
                    "full: columns and rows, each bit with its inverse; fast: a third of the pictures, columns only, 5 shifts; "
                    "multi-frequency: fringes of three or four periods instead of the Gray code")
        ->capture_default_str()
        ->check(CLI::IsMember({"full", "fast", "multi-frequency"}));
    sub->add_flag("--columns-only", o.columns_only, "Half the pictures (not with the set fast, which has no rows); points then need both cameras");
    sub->add_option("--phase-period-px", o.phase_period_px, "Projector pixels a fringe")
        ->capture_default_str()
        ->check(CLI::Range(4.0, 256.0));
    sub->add_option("--out", o.out, "Folder to write")->required();
    json_flag(sub, o.json);
}

void add_board(CLI::App& app, BoardOptions& o) {
    auto* sub = command(app, "board", "Draw the calibration board to print (PNG and PDF, true size, grey instead of black)",
                        "board --board \"charuco 10x7 25 mm\" --out board");
    sub->add_option("--board", o.board,
                    "charuco COLUMNSxROWS (squares) or chessboard COLUMNSxROWS (inner corners), and the square in mm")
        ->capture_default_str();
    sub->add_option("--out", o.out, "File to write, without ending")->capture_default_str();
    json_flag(sub, o.json);
}

void add_calibrate(CLI::App& app, CalibrateOptions& o) {
    auto* sub = command(app, "calibrate", "Captures of a board under coded light -> rig.json, or a refusal (exit 6)",
                        "calibrate captures --board \"charuco 10x7 25 mm\" --out rig.json");
    sub->add_option("captures", o.captures, "Folder with one folder a pose")->required();
    sub->add_option("--board", o.board,
                    "The board, its square as measured: \"charuco 10x7 24.98 mm\" or \"chessboard 9x6 25 mm\"")
        ->required();
    sub->add_option("--serial-left", o.serial_left,
                    "Serial of the left camera, kept in rig.json (default: as capture.json says)");
    sub->add_option("--serial-right", o.serial_right, "Of the right camera");
    sub->add_option("--serial-projector", o.serial_projector,
                    "Of the projector; `projector --identify` tells it where the monitor does");
    sub->add_option("--out", o.out, "rig.json to write; the report stands beside it")->capture_default_str();
    json_flag(sub, o.json);
}

void add_check(CLI::App& app, CheckOptions& o) {
    auto* sub = command(app, "check", "One scan of anything against rig.json: has the rig moved? (exit 6 if so)",
                        "check room/capture --rig room/rig.json");
    sub->add_option("capture", o.capture, "Capture folder of a scan: a board, a phantom, the patient")->required();
    sub->add_option("--rig", o.rig, "rig.json")->required();
    sub->add_option("--log", o.log, "Where the checks are kept for the trend (default: beside rig.json)");
    json_flag(sub, o.json);
}

void add_simulate(CLI::App& app, SimulateOptions& o) {
    auto* sub = command(app, "simulate", "Captures of a simulated room, with ground truth in a file of its own",
                        "simulate Cranium.inv3 --plan frontal_defect.mrk.json --preset paper --seed 3 --out room");
    sub->add_option("volume", o.volume, "The patient: DICOM folder or file, or InVesalius project");
    sub->add_option("--board", o.board,
                    "Instead of a patient a calibration board, as for `calibrate`; writes captures/ and truth.json");
    sub->add_option("--poses", o.poses, "Of the board")->capture_default_str()->check(CLI::Range(1, 1000));
    sub->add_option("--plan", o.plan, "Plan, so that markers keep clear of it");
    preset_option(sub, o.preset);
    sub->add_option("--seed", o.seed, "Of everything random")->capture_default_str();
    sub->add_option("--frames", o.frames, "Tracking frames after the scan")->capture_default_str()->check(CLI::Range(0, 10000));
    sub->add_option("--speed-mm-s", o.speed_mm_s, "Peak speed of the head in the tracking frames")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 500.0));
    sub->add_option("--out", o.out, "Folder to write: rig.json, capture/, frames/, truth.json")->required();
    json_flag(sub, o.json);
}

void add_scan(CLI::App& app, ScanOptions& o) {
    auto* sub = command(app, "scan", "Captured stripe pictures -> cloud of skin points in rig",
                        "scan room/capture --rig room/rig.json --out cloud.ply");
    sub->add_option("capture", o.capture, "Capture folder")->required();
    sub->add_option("--exposure", o.exposures, "Another capture of the same pose, darker or brighter; may be said again");
    sub->add_option("--rig", o.rig, "rig.json")->required();
    sub->add_option("--out", o.out, "Clean cloud (.ply)")->required();
    sub->add_option("--raw", o.raw_out, "Also the cloud before the outliers were removed (.ply)");
    sub->add_option("--surface", o.surface_out, "Also the scan as a triangulated surface (.ply: the same points, with faces)");
    sub->add_option("--max-movement-mm", o.max_movement_mm, "Of the patient during the scan; more is refused (exit 6)")
        ->capture_default_str()
        ->check(CLI::Range(0.01, 100.0));
    sub->add_flag("--accept-movement", o.accept_movement, "Write the cloud of a patient who moved; only warn");
    json_flag(sub, o.json);
}

void add_register(CLI::App& app, RegisterOptions& o) {
    auto* sub = command(app, "register", "Cloud and case -> where the patient lies (T_ini), or a refusal (exit 6)",
                        "register case --cloud cloud.ply --out registration.json");
    sub->add_option("case", o.case_folder, "Case folder")->required();
    auto* cloud = sub->add_option("--cloud", o.cloud, "Clean cloud (.ply), of `scan` or of any scanner");
    sub->add_option("--unit", o.unit, "Unit of the cloud's numbers")
        ->check(CLI::IsMember({"mm", "cm", "m", "um", "inch"}))
        ->capture_default_str()
        ->needs(cloud);
    sub->add_flag("--in-rig", o.in_rig, "The cloud is in the rig's frame though it does not say so")->needs(cloud);
    sub->add_option("--viewpoint", o.viewpoint_in_rig,
                    "Where the scanner stood (rig, mm): then the space it looked through must be free in the CT too; a cloud "
                    "without normals needs it")
        ->expected(3)
        ->needs(cloud);
    sub->add_option("--pairs", o.pairs,
                    "Landmarks (.csv: name, ct and rig coordinates; `review --landmarks` clicks them): they check the cloud's "
                    "match, help where it is refused, or, without a cloud, are the match");
    sub->add_option("--certificate", o.certificate, "Write a page (.html) with what the match is worth, in words and pictures");
    sub->add_option("--out", o.out, "registration.json to write")->required();
    sub->add_option("--slicer", o.slicer_transform, "Transform for 3D Slicer to write (.tfm): it lays the cloud on the CT");
    sub->add_option("--icp", o.icp, "Fine match: signed-distance, or closest-point as in the paper")
        ->check(CLI::IsMember({"signed-distance", "closest-point"}))->capture_default_str();
    sub->add_option("--seed", o.seed, "Of the search")->capture_default_str();
    json_flag(sub, o.json);
}

void add_track(CLI::App& app, TrackOptions& o) {
    auto* sub = command(app, "track", "Recorded frames -> poses of the patient (T_cur)",
                        "track room/frames --rig room/rig.json --capture room/capture --out poses.json");
    sub->add_option("frames", o.frames, "Folder of recorded frames")->required();
    sub->add_option("--rig", o.rig, "rig.json")->required();
    sub->add_option(
        "--capture", o.capture,
        "Capture folder of the scan: its white picture holds the reference markers (default: the first frame)");
    sub->add_option("--out", o.out, "poses.json to write")->required();
    json_flag(sub, o.json);
}

void add_project(CLI::App& app, ProjectOptions& o) {
    auto* sub = command(app, "project", "Case, registration and pose -> the projector's picture",
                        "project case --rig room/rig.json --registration registration.json --out light.png");
    sub->add_option("case", o.case_folder, "Case folder")->required();
    sub->add_option("--rig", o.rig, "rig.json")->required();
    sub->add_option("--registration", o.registration, "registration.json")->required();
    sub->add_option("--poses", o.poses, "poses.json (default: the patient has not moved since the scan)");
    sub->add_option("--frame", o.frame, "Which pose (default: the last)");
    sub->add_flag("--confirmed", o.confirmed, "The overlay was looked at on landmarks (for the verdict `ask`)");
    sub->add_option("--out", o.out, "Picture to write (.png)")->required();
    json_flag(sub, o.json);
}

void add_projector(CLI::App& app, ProjectorOptions& o) {
    auto* sub = command(
        app, "projector", "What the projector really does: gamma, colour cycle, latency; which monitor it is",
        "projector recording --configured-ms 25 --serial X7K2 --out projector.json\n"
        "  planlight projector --simulate paper --seed 3 --light wheel-hz=120 delay-ms=12 --out projector.json\n"
        "  planlight projector --identify\n"
        "  planlight projector --show --monitor HDMI-2 --frames-hz 60 --keep recording");
    auto* recording =
        sub->add_option("recording", o.recording, "Folder with latency/, response/, cycle/ (any of them)");
    auto* simulate =
        sub->add_option("--simulate", o.simulate, "Measure the simulated room's projector instead: modern or paper")
            ->check(CLI::IsMember({"modern", "paper"}))
            ->excludes(recording);
    sub->add_option("--seed", o.seed, "Of the simulated room, and of the order of greys")->capture_default_str();
    sub->add_option("--light", o.light,
                    "Of the simulated room, NAME=NUMBER: gamma, dark-end, wheel-hz, mains-hz, delay-ms, ...")
        ->needs(simulate);
    sub->add_option("--keep", o.keep, "Folder to keep what was recorded, or shown, in")->excludes(recording);
    sub->add_option("--part", o.part, "latency, response, cycle or all")
        ->check(CLI::IsMember({"all", "latency", "response", "cycle"}))
        ->capture_default_str();
    sub->add_option("--refresh-hz", o.refresh_hz, "Of the projector")
        ->capture_default_str()
        ->check(CLI::Range(10.0, 1000.0));
    sub->add_option("--refresh-tolerance-hz", o.refresh_tolerance_hz,
                    "How well that is known; a few thousandths tell cycles apart that 0.1 does not")
        ->capture_default_str()
        ->check(CLI::Range(1e-6, 10.0));
    sub->add_option("--configured-ms", o.configured_delay_ms,
                    "The delay in force, to be compared (default: as recorded)")
        ->check(CLI::Range(0.0, 10000.0));
    sub->add_option("--serial", o.serial, "Of the projector, as on its label");
    sub->add_option("--monitor", o.monitor, "Monitor that it is");
    auto* show = sub->add_flag("--show", o.show,
                               "Show the light of each part on --monitor for your own cameras, and keep the orders; "
                               "nobody may lie there")
                     ->excludes(recording)
                     ->excludes(simulate);
    sub->add_option("--frames-hz", o.frames_hz, "Of your own cameras")
        ->capture_default_str()
        ->check(CLI::Range(1.0, 1000.0))
        ->needs(show);
    auto* identify =
        sub->add_flag(
               "--identify", o.identify,
               "Every monitor shows its own name for a while, then goes dark; nobody may lie under the projector")
            ->excludes(recording)
            ->excludes(show)
            ->excludes(simulate);
    sub->add_option("--seconds", o.seconds, "Of --identify; 0 only lists the monitors")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 60.0))
        ->needs(identify);
    sub->add_option("--out", o.out, "projector.json to write; the page stands beside it");
    json_flag(sub, o.json);
}

void add_review(CLI::App& app, ReviewOptions& o) {
    auto* sub = command(app, "review", "Look at a prepared case, or at a match on it, in the operator window",
                        "review case --registration registration.json --cloud cloud.ply");
    sub->add_option("case", o.case_folder, "Case folder")->required();
    auto* match = sub->add_option("--registration", o.registration, "A match to look at (registration.json of `register`)");
    auto* cloud = sub->add_option(
        "--cloud", o.cloud, "The scan (.ply, mm): shown on the skin, coloured by distance, as it was matched, or to click on");
    auto* landmarks = sub->add_option(
        "--landmarks", o.landmarks, "Click landmarks on the skin and the scan, and keep them in this table (.csv) for `register --pairs`");
    landmarks->needs(cloud);
    sub->add_option("--view", o.view, "before or after the fine match, or error: how far off the match may be")
        ->check(CLI::IsMember({"before", "after", "error"}))
        ->capture_default_str()
        ->needs(match);
    sub->add_option("--picture", o.picture, "Write a picture (.png) instead of opening a window; needs no display")
        ->excludes(landmarks);
    json_flag(sub, o.json);
}

void add_session(CLI::App& app, SessionOptions& o) {
    auto* sub = command(app, "session", "Live: operator window and projector window, on the simulated room, the head moving",
                        "session case --volume Cranium.inv3 --projector HDMI-2");
    sub->add_option("case", o.case_folder, "Case folder")->required();
    sub->add_option("--volume", o.volume, "The simulated patient: the volume that the case was made from")->required();
    sub->add_option("--keep", o.keep, "Folder that keeps every match and its scan (default: CASE/registrations)");
    preset_option(sub, o.preset);
    sub->add_option(
        "--projector", o.projector_monitor,
        "Monitor (name or number) that is the projector; without it the light is shown in the operator window only");
    auto* delay = sub->add_option("--light-delay-ms", o.light_delay_ms,
                                  "From showing to light, as `projector` measured it (default: 25)")
                      ->check(CLI::Range(0.0, 10000.0));
    sub->add_option("--projector-file", o.projector_file,
                    "projector.json of `projector`: its delay is used; another monitor, resolution or serial is "
                    "refused (exit 6)")
        ->excludes(delay);
    sub->add_option("--operator", o.operator_monitor, "Monitor of the operator window (default: the primary one)");
    sub->add_option("--seed", o.seed, "Of the simulated room")->capture_default_str();
    sub->add_option("--speed-mm-s", o.speed_mm_s, "Peak speed of the head")->capture_default_str()->check(CLI::Range(0.0, 500.0));
    sub->add_flag("--autoplay", o.autoplay, "Scan, register and track by itself");
    sub->add_option("--end-after-s", o.end_after_s, "Close after this many seconds of tracking");
    sub->add_option("--screenshots", o.screenshots, "Folder for screenshots of every step");
}

void add_demo(CLI::App& app, DemoOptions& o) {
    auto* sub = command(app, "demo", "The whole chain on the example patient, with a report of how true the light was",
                        "demo --headless --seed 3 --out demo-3");
    sub->add_option("--volume", o.volume, "Patient")->capture_default_str();
    sub->add_option("--plan", o.plan, "Plan (default: the example plan)");
    sub->add_option("--preset", o.preset, "modern, paper or both")
        ->check(CLI::IsMember({"modern", "paper", "both"}))
        ->capture_default_str();
    sub->add_option("--seed", o.seed, "First seed of the simulated rooms")->capture_default_str();
    sub->add_option("--seeds", o.seeds, "Rooms a preset")->capture_default_str()->check(CLI::Range(1, 10000));
    sub->add_option("--jobs", o.jobs, "Rooms at a time (they slow each other down: read the times with one)")
        ->capture_default_str()
        ->check(CLI::Range(1, 256));
    sub->add_flag("--headless", o.headless, "No windows, even where there is a display");
    sub->add_flag("--no-pictures", o.no_pictures, "No pictures in the report (a machine without OpenGL)");
    sub->add_option("--out", o.out, "Folder of report.html and report.json")->capture_default_str();
    json_flag(sub, o.json);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Planlight shows a surgical plan as light on the patient.\n", "planlight"};
    app.footer(std::string("planlight COMMAND --help shows a command's options and an example.\n") + kExitCodes);
    app.require_subcommand(1);
    app.set_version_flag("--version", "planlight 0.1.0");
    PrepareOptions prepare;
    PlanOptions plan;
    PatternsOptions patterns;
    BoardOptions board;
    CalibrateOptions calibrate;
    CheckOptions check;
    SimulateOptions simulate;
    ScanOptions scan;
    RegisterOptions registration;
    TrackOptions track;
    ProjectOptions project;
    ProjectorOptions projector;
    ReviewOptions review;
    SessionOptions session;
    DemoOptions demo;
    add_demo(app, demo);
    add_prepare(app, prepare);
    add_plan(app, plan);
    add_patterns(app, patterns);
    add_board(app, board);
    add_calibrate(app, calibrate);
    add_check(app, check);
    add_scan(app, scan);
    add_register(app, registration);
    add_track(app, track);
    add_project(app, project);
    add_projector(app, projector);
    add_session(app, session);
    add_review(app, review);
    add_simulate(app, simulate);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
    }
    return run_and_explain([&] {
        const std::string name = app.get_subcommands().front()->get_name();
        if (name == "demo") return run_demo(demo);
        if (name == "prepare") return run_prepare(prepare);
        if (name == "plan") return run_plan(plan);
        if (name == "patterns") return run_patterns(patterns);
        if (name == "board") return run_board(board);
        if (name == "calibrate") return run_calibrate(calibrate);
        if (name == "check") return run_check(check);
        if (name == "scan") return run_scan(scan);
        if (name == "register") return run_register(registration);
        if (name == "track") return run_track(track);
        if (name == "project") return run_project(project);
        if (name == "session") return run_session(session);
        if (name == "projector") return run_projector(projector);
        if (name == "review") return run_review(review);
        return run_simulate(simulate);
    });
}
