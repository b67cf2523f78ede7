#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/capture_conversion.h"
#include "app/commands/commands.h"
#include "app/console.h"
#include "planning_io/plan_file.h"
#include "planning_io/read_volume.h"
#include "planning_io/rig_file.h"
#include "planning_io/safe_write.h"
#include "planning_io/types/error.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight {
namespace {

std::vector<RecordedFrame> record_frames(simulation::SimulatedRig& rig, const SimulateOptions& options, ProgressBar& bar) {
    rig.set_motion({options.speed_mm_s, rig.clock().now()});
    std::vector<RecordedFrame> frames;
    for (int i = 0; i < options.frames; ++i) {
        const StereoFrame frame = rig.cameras().grab(rig.clock().now(), std::chrono::seconds(1));
        frames.push_back({frame.left, frame.right, frame.at, frame.exposure, frame.number});
        bar.show("frames", static_cast<double>(i + 1) / options.frames);
    }
    return frames;
}

}  // namespace

int run_simulate(const SimulateOptions& options) {
    if (!options.board.empty()) return run_simulate_board(options);
    if (options.volume.empty())
        throw InputError({}, "neither a patient nor a board is given", "Name a volume, or a board with --board.");
    const Volume volume = read_volume(options.volume);
    const Plan plan = options.plan.empty() ? Plan{} : read_plan(options.plan);
    simulation::RoomSettings room;
    room.preset = options.preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
    room.seed = options.seed;
    simulation::SimulatedRig rig(volume, points_of(plan), room);
    std::filesystem::create_directories(options.out);
    write_rig(rig.calibration(), options.out / "rig.json");
    ProgressBar bar;
    StripeSettings stripes;
    stripes.width = rig.projector().width();
    stripes.height = rig.projector().height();
    const ScanCapture capture = capture_scan(rig.projector(), rig.cameras(), rig.clock(), stripes, [&](int done, int of) {
        bar.show("scan", static_cast<double>(done) / of);
    });
    write_capture(capture_folder_from(capture), options.out / "capture");
    const auto frames = record_frames(rig, options, bar);
    write_frames(frames, options.out / "frames");

    nlohmann::json truth = nlohmann::json::parse(rig.truth_json());
    const auto rows = [](const RigidTransform& t) {
        nlohmann::json m = nlohmann::json::array();
        for (int r = 0; r < 4; ++r) m.push_back({t(r, 0), t(r, 1), t(r, 2), t(r, 3)});
        return m;
    };
    truth["scan_rig_from_ct"] = rows(rig.true_rig_from_ct(capture.began));
    for (const auto& frame : frames)
        truth["frames"].push_back({{"number", frame.number}, {"rig_from_ct", rows(rig.true_rig_from_ct(frame.at))}});
    write_safely(options.out / "truth.json", truth.dump(2) + "\n");
    const nlohmann::json result = {{"folder", options.out.string()}, {"preset", options.preset}, {"seed", options.seed},
                                   {"patterns", capture.left.size()}, {"frames", frames.size()}};
    if (options.json) std::cout << result.dump(2) << '\n';
    else
        fmt::print("{}: rig.json, capture ({} pictures a camera), frames ({}), truth.json.\n", options.out.string(),
                   capture.left.size(), frames.size());
    return 0;
}

}  // namespace planlight
