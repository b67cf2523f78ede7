#include <fmt/format.h>

#include <iostream>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/example_plan.h"
#include "app/commands/pdf_option.h"
#include "app/commands/plan_options.h"
#include "app/console.h"
#include "app/evaluation/chain_pictures.h"
#include "app/evaluation/chain_report.h"
#include "app/evaluation/run_rooms.h"
#include "app/live/live_window.h"
#include "app/live/simulated_room.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"

namespace planlight {
namespace {

struct DemoOptions {
    Path volume = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
    Path plan, out = "planlight-demo", pdf;
    std::string series_uid, frame, accept_frame;  ///< of the volume; of a plan that does not say its coordinate system
    std::string preset = "both";
    unsigned seed = 1;
    int seeds = 1, jobs = 1;
    bool headless = false, no_pictures = false, json = false;
};

std::vector<simulation::Preset> presets_of(const DemoOptions& options) {
    using simulation::Preset;
    if (options.preset == "paper") return {Preset::paper};
    if (options.preset == "modern") return {Preset::modern};
    return {Preset::paper, Preset::modern};
}

int run_demo(const DemoOptions& options) {
    check_pdf(options.pdf, options.out);
    if (!std::filesystem::exists(options.volume))
        throw InputError(options.volume, "the patient is not there",
                         "Install the package invesalius-examples, or give --volume.");
    ProgressBar bar;
    bar.show("volume", 0);
    const Volume volume = read_volume(options.volume, options.series_uid);
    bar.show("volume", 1);
    const Plan plan = options.plan.empty()
                          ? example_plan()
                          : import_plan(options.plan, plan_settings(options.frame, options.accept_frame,
                                                                    volume.frame_of_reference_uid))
                                .plan;
    const Preparation prepared = prepare_case(volume, plan, {}, {}, iso_date_now(), {bar.callback(), {}});
    make_folder(options.out);
    write_case(prepared.prepared, options.out / "case", true);
    const CaseDrawing drawing(prepared.prepared);

    std::vector<ChainSettings> settings;
    for (const auto preset : presets_of(options))
        for (int i = 0; i < options.seeds; ++i) {
            settings.emplace_back();
            settings.back().preset = preset;
            settings.back().seed = options.seed + static_cast<unsigned>(i);
        }
    ChainPictures pictures(prepared.prepared, drawing);
    // The pictures are of the last preset's first room.
    const auto with_pictures = settings.size() - static_cast<std::size_t>(options.seeds);
    const auto watcher_of = [&](std::size_t room) {
        ChainWatcher watcher;
        if (options.jobs == 1)
            watcher.progress = [&, room](const std::string& stage, double share) {
                bar.show(fmt::format("{} {}: {}", name_of(settings[room].preset), settings[room].seed, stage), share);
            };
        if (room == with_pictures && !options.no_pictures) pictures.watch(watcher);
        return watcher;
    };
    std::size_t done = 0;
    const auto finished = [&](std::size_t, const ChainFigures& room) {
        bar.note(fmt::format("room {} of {}: {} {}{}", ++done, settings.size(), room.preset, room.seed,
                             room.refused.empty() ? "" : ", refused: " + room.refused));
    };
    const auto rooms = run_rooms(volume, prepared.prepared, drawing, settings, options.jobs, watcher_of, finished);
    const std::string json = write_report_json(options.out / "report.json", prepared, rooms);
    const Document document = chain_document(prepared, rooms, pictures.pictures());
    write_safely(options.out / "report.html", html_of(document));
    write_pdf(document, options.pdf);
    if (options.json) std::cout << json;
    for (const auto* preset : {"paper", "modern"})
        if (const auto s = summarise(rooms, preset); s.rooms > 0 && !options.json) fmt::print("{}", summary_text(s));
    if (!options.json) fmt::print("\nReport: {}\n", (options.out / "report.html").string());
    if (!options.headless && display_is_there()) {
        LiveOptions live;
        live.autoplay = true;
        simulation::RoomSettings room;
        room.preset = presets_of(options).front();
        room.seed = options.seed;
        constexpr double kSpeed_mm_s = 20;
        const auto make_room = [&](const RoomProgress&) {
            return std::make_unique<SimulatedRoom>(volume, prepared.prepared.plan, room, kSpeed_mm_s);
        };
        SessionWindow window("");
        return run_live_simulated(window, make_room, prepared.prepared, drawing, live);
    }
    return 0;
}

}  // namespace

Run add_demo(CLI::App& app) {
    const auto options = std::make_shared<DemoOptions>();
    DemoOptions& o = *options;
    auto* sub =
        add_command(app, "demo", "The whole chain on the example patient, with a report of how true the light was",
                    "demo --headless --seed 3 --out demo-3 --pdf demo-3/report.pdf");
    sub->add_option("--volume", o.volume, "Patient")->capture_default_str();
    series_option(sub, o.series_uid);
    sub->add_option("--plan", o.plan, "Plan (default: the example plan)");
    plan_frame_options(sub, o.frame, o.accept_frame);
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
    pdf_option(sub, o.pdf);
    json_flag(sub, o.json);
    return [options] { return run_demo(*options); };
}

}  // namespace planlight
