#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/capture_conversion.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/plan_options.h"
#include "app/commands/simulate_options.h"
#include "app/console.h"
#include "app/json_text.h"
#include "planning_io/case/frames_folder.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "registration/simulation/simulated_rig.h"
#include "segmentation/skin_threshold.h"

namespace planlight {
namespace {

const std::vector<std::string> kThings{"drape-behind", "drape-hole", "hair", "hand", "tube", "retractor"};

simulation::ThingsSettings things_of(const SimulateOptions& options) {
    const auto asked = [&](const std::string& name) {
        return std::find(options.with.begin(), options.with.end(), name) != options.with.end();
    };
    simulation::ThingsSettings things;
    things.drape_behind = asked("drape-behind");
    things.drape_hole = asked("drape-hole");
    things.hair = asked("hair");
    things.hand = asked("hand");
    things.tube = asked("tube");
    things.retractor = asked("retractor");
    things.hole_mm = options.hole_mm;
    return things;
}

std::vector<StereoFrame> record_frames(simulation::SimulatedRig& rig, const SimulateOptions& options,
                                       ProgressBar& bar) {
    rig.set_motion({options.speed_mm_s, rig.clock().now()});
    std::vector<StereoFrame> frames;
    for (int i = 0; i < options.frames; ++i) {
        frames.push_back(rig.cameras().grab(rig.clock().now(), std::chrono::seconds(1)));
        bar.show("frames", static_cast<double>(i + 1) / options.frames);
    }
    return frames;
}

/// The rig of real devices is not to be lost to a simulated room.
void check_folder(const Path& folder) {
    std::error_code ignored;
    const auto is_there = [&](const char* name) { return std::filesystem::exists(folder / name, ignored); };
    for (const char* name : {"rig.json", "room.json"})
        if (is_there(name) && !is_there("truth.json"))
            throw InputError(folder, fmt::format("holds a {} that is of no simulated room", name),
                             "Name a new folder with --out.");
}

int run_simulate(const SimulateOptions& options) {
    if (options.addresses.size() != 2)
        throw Error(
            ExitCode::usage,
            fmt::format("--addresses has {} of the two that are wanted, one for each camera", options.addresses.size()),
            "Give --addresses 127.0.0.1,127.0.0.2.");
    check_folder(options.out);
    if (!options.board.empty()) return run_simulate_board(options);
    if (options.volume.empty())
        throw Error(ExitCode::usage, "neither a patient nor a board is given",
                    "Name a volume, or a board with --board.");
    const Volume volume = read_volume(options.volume, options.series_uid);
    const Plan plan = options.plan.empty()
                          ? Plan{}
                          : import_plan(options.plan, plan_settings(options.frame, options.accept_frame,
                                                                    volume.frame_of_reference_uid))
                                .plan;
    simulation::RoomSettings room;
    room.preset = options.preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
    room.seed = options.seed;
    room.things = things_of(options);
    if (!volume.is_hu) room.skin_threshold_hu = skin_threshold(volume);
    room.wet = options.wet;
    room.projector_delay = from_seconds(options.projector_delay_ms / 1e3);
    room.light.whole_exposure = !options.serve.empty();  // as real cameras see it
    simulation::SimulatedRig rig(volume, points_of(plan), room);
    if (!options.serve.empty()) return run_simulate_served(options, rig);
    make_folder(options.out);
    ProgressBar bar;
    StripeSettings stripes;
    stripes.width = rig.projector().width();
    stripes.height = rig.projector().height();
    const ScanCapture capture =
        capture_scan(rig.projector(), rig.cameras(), rig.clock(), stripes,
                     [&](int done, int of) { bar.show("scan", static_cast<double>(done) / of); });
    write_capture(capture_folder_from(capture), options.out / "capture");
    const auto frames = record_frames(rig, options, bar);
    write_frames(frames, options.out / "frames");
    write_rig(rig.calibration(), options.out / "rig.json");

    nlohmann::json truth = nlohmann::json::parse(rig.truth_json());
    const auto rows = [](const RigidTransform& t) {
        nlohmann::json m = nlohmann::json::array();
        for (int r = 0; r < 4; ++r) m.push_back({t(r, 0), t(r, 1), t(r, 2), t(r, 3)});
        return m;
    };
    truth["scan_rig_from_ct"] = rows(rig.true_rig_from_ct(capture.began));
    for (const auto& frame : frames)
        truth["frames"].push_back({{"number", frame.number}, {"rig_from_ct", rows(rig.true_rig_from_ct(frame.at))}});
    write_safely(options.out / "truth.json", json_text(truth) + "\n");
    const nlohmann::json result = {{"folder", options.out.string()},
                                   {"preset", options.preset},
                                   {"seed", options.seed},
                                   {"patterns", capture.left.size()},
                                   {"frames", frames.size()}};
    if (options.json)
        std::cout << json_text(result) << '\n';
    else
        fmt::print("{}: rig.json, capture ({} pictures a camera), frames ({}), truth.json.\n", options.out.string(),
                   capture.left.size(), frames.size());
    return 0;
}

}  // namespace

Run add_simulate(CLI::App& app) {
    const auto options = std::make_shared<SimulateOptions>();
    SimulateOptions& o = *options;
    auto* sub = add_command(app, "simulate", "Captures of a simulated room, with ground truth in a file of its own",
                            "simulate Cranium.inv3 --plan frontal_defect.mrk.json --preset paper --seed 3 --out room");
    auto* volume = sub->add_option(
        "volume", o.volume,
        "The patient: DICOM folder or file, NIfTI, FreeSurfer MGZ, NRRD, MetaImage, or InVesalius project (.inv3)");
    sub->add_option(
           "--board", o.board,
           "Instead of a patient a calibration board, as for `calibrate`; writes captures/ and truth.json. Served: "
           "a person carries it about")
        ->excludes(volume);
    sub->add_option("--poses", o.poses, "Of the board")->capture_default_str()->check(CLI::Range(1, 1000));
    sub->add_option("--plan", o.plan, "Plan, so that markers keep clear of it");
    series_option(sub, o.series_uid);
    plan_frame_options(sub, o.frame, o.accept_frame);
    preset_option(sub, o.preset);
    sub->add_option("--seed", o.seed, "Of everything random")->capture_default_str();
    sub->add_option("--frames", o.frames, "Tracking frames after the scan")
        ->capture_default_str()
        ->check(CLI::Range(0, 10000));
    sub->add_option(
           "--speed-mm-s", o.speed_mm_s,
           "Peak speed of the head in the tracking frames. Served (default: 0): from the light of a plan on, until "
           "stripes come")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 500.0));
    sub->add_option("--with", o.with,
                    "What else is in the room: drape-behind (a sheet on the table), drape-hole (laid over the head), "
                    "hair, hand, tube, retractor; several with commas")
        ->delimiter(',')
        ->check(CLI::IsMember(kThings));
    sub->add_option("--hole-mm", o.hole_mm, "Width of the hole of drape-hole")
        ->capture_default_str()
        ->check(CLI::Range(40.0, 300.0));
    sub->add_option("--wet", o.wet, "Wet skin: 0 dry to 1, with the highlights of a film of water")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 1.0));
    sub->add_option("--projector-delay-ms", o.projector_delay_ms,
                    "From the order of a picture, served: its standing on the monitor, to its light")
        ->capture_default_str()
        ->check(CLI::Range(10.0, 1000.0));
    auto* serve = sub->add_option(
        "--serve", o.serve,
        "Serve the room as hardware until Ctrl-C: two GigE Vision cameras, and the light of this monitor; "
        "writes room.json, truth.json and, of a patient's room, rig.json (of a board's the calibration makes it)");
    sub->add_option("--addresses", o.addresses, "Of the served cameras, one each, of this machine")
        ->delimiter(',')
        ->capture_default_str()
        ->needs(serve);
    sub->add_option("--lose-packets", o.lose_packets,
                    "Share of its packets that the left served camera loses, and never sends again")
        ->check(CLI::Range(0.0, 1.0))
        ->needs(serve);
    sub->add_option("--right-behind", o.right_behind, "The right served camera sends each picture so many frames late")
        ->check(CLI::Range(0, 10))
        ->needs(serve);
    sub->add_option("--out", o.out, "Folder to write: rig.json, capture/, frames/, truth.json")->required();
    json_flag(sub, o.json);
    return [options, sub] {
        if (sub->count("--speed-mm-s") == 0 && !options->serve.empty()) options->speed_mm_s = 0;
        return run_simulate(*options);
    };
}

}  // namespace planlight
