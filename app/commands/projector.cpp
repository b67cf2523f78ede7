#include <fmt/format.h>

#include <thread>

#include <algorithm>
#include <iostream>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/pdf_option.h"
#include "app/console.h"
#include "app/live/identify_monitors.h"
#include "app/live/light_source.h"
#include "app/live/projector_options.h"
#include "app/live/room_cameras.h"
#include "app/live/show_light.h"
#include "app/report/projector_report.h"
#include "planning_io/case/room_file.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

bool wanted(const ProjectorOptions& options, const std::string& part) {
    return options.part == "all" || options.part == part;
}

void evaluate(const std::string& part, LightRecording recording, const ProjectorOptions& options,
              ProjectorReport& report) {
    if (options.configured_delay_ms >= 0)
        for (LightOrder& order : recording.orders)
            order.promised = order.returned.value_or(order.at) + from_seconds(options.configured_delay_ms / 1e3);
    if (part == "response") report.response = measure_response(recording);
    CycleSettings cycle;
    cycle.refresh_hz = options.refresh_hz;
    cycle.refresh_tolerance_hz = options.refresh_tolerance_hz;
    if (part == "cycle") report.cycle = measure_cycle(recording, cycle);
    LatencySettings latency;
    latency.refresh_hz = options.refresh_hz;
    if (part == "latency") report.latency = measure_latency(recording, latency);
}

void measure_simulated(const ProjectorOptions& options, ProjectorReport& report) {
    simulation::BoardRoomSettings settings;
    settings.preset = options.simulate == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
    settings.seed = options.seed;
    settings.poses = 1;
    settings.max_tilt_deg = 20;
    settings.light.whole_exposure = true;
    set_simulated_light(options.light, settings);
    report.source = fmt::format("simulated room ({}, seed {}), a white card", options.simulate, options.seed);
    if (!options.keep.empty()) make_folder(options.keep);
    ProgressBar bar;
    for (const std::string part : kLightParts) {
        if (!wanted(options, part)) continue;
        simulation::SimulatedBoardRoom room(simulation::white_card(), settings);
        report.width = room.projector().width();
        report.height = room.projector().height();
        RecordSettings record;
        record.seed = options.seed;
        if (report.latency && !report.latency->refusal)
            record.settle = std::max(record.settle, 2 * from_seconds(report.latency->latest_s));
        const LightBench bench{room.projector(),
                               room.cameras(),
                               room.clock(),
                               [&](Instant at) { room.wait(at - room.clock().now()); },
                               [&](double share) { bar.show(part, share); },
                               {}};
        const auto cover = [&](const LightBench& with, LightRecording& recording) {
            if (part != "response") return;
            room.cover_projector(true);
            record_covered(with, recording, record);
        };
        evaluate(part, record_part(part, bench, record, options.keep.empty() ? Path{} : options.keep / part, cover),
                 options, report);
    }
}

/// The projector of a room, by its own cameras; the delay in force is that of its projector.json.
void measure_room(const ProjectorOptions& options, ProjectorReport& report) {
    const RoomFile room = read_room(options.room);
    const SteadyClock clock;
    RoomCameras cameras(room, clock);
    for (const std::string& note : cameras.notes()) warn(note + ".");
    CommandProjector projector(room, &cameras);
    report.source = room.name.empty() ? options.room.string() : room.name;
    report.monitor = room.monitor;
    report.width = projector.projector().width();
    report.height = projector.projector().height();
    if (!options.keep.empty()) make_folder(options.keep);
    ProgressBar bar;
    for (const std::string part : kLightParts) {
        if (!wanted(options, part)) continue;
        RecordSettings record;
        record.seed = options.seed;
        const LightBench bench{projector.projector(),
                               cameras.pair(),
                               clock,
                               [&](Instant at) { std::this_thread::sleep_for(at - clock.now()); },
                               [&](double share) { bar.show(part, share); },
                               {}};
        evaluate(part, record_part(part, bench, record, options.keep.empty() ? Path{} : options.keep / part), options,
                 report);
    }
}

void measure_recorded(const ProjectorOptions& options, ProjectorReport& report) {
    report.source = options.recording.string();
    bool any = false;
    for (const std::string part : kLightParts) {
        const Path folder = options.recording / part;
        if (!wanted(options, part) || !std::filesystem::exists(folder / "light.json")) continue;
        evaluate(part, read_light_folder(folder), options, report);
        any = true;
    }
    if (!any)
        throw InputError(
            options.recording, "holds no recording of light (latency/, response/ or cycle/, each with its light.json)",
            "Record one; registration/projector_measurement/README.md (below /usr/share/doc/planlight when "
            "installed) says how.");
}

template <class Result>
void throw_if_refused(const std::optional<Result>& result, const char* what) {
    if (result && result->refusal)
        throw CheckFailedError(fmt::format("{}: {}", what, result->refusal->reason), result->refusal->remedy);
}

int run_projector(const ProjectorOptions& options) {
    if (options.identify) return identify_monitors(options);
    if (options.show) return show_light(options);
    if (options.recording.empty() && options.simulate.empty() && options.room.empty())
        throw Error(ExitCode::usage, "there is nothing to measure",
                    "Give --room, a folder of recorded light, --simulate, --show or --identify.");
    const Path page = options.out.empty() ? Path() : Path(options.out).replace_extension(".html");
    check_pdf(options.pdf);
    ProjectorReport report;
    report.made_on = today();
    report.serial = options.serial;
    report.monitor = options.monitor;
    if (!options.room.empty())
        measure_room(options, report);
    else if (!options.recording.empty())
        measure_recorded(options, report);
    else
        measure_simulated(options, report);
    const std::string text = projector_json(report);
    if (options.json)
        std::cout << text;
    else
        fmt::print("{}", projector_summary(report));
    std::cout.flush();
    for (const LightFinding& finding : findings_of(report)) warn(finding.what + ". " + finding.remedy);
    throw_if_refused(report.latency, "latency");
    throw_if_refused(report.response, "response");
    throw_if_refused(report.cycle, "colour cycle");
    if (options.out.empty() && options.pdf.empty()) return 0;
    const Document document = projector_document(report);
    if (options.out.empty()) {
        write_pdf(document, options.pdf);
        return 0;
    }
    write_safely(options.out, text);
    write_safely(page, html_of(document));
    write_pdf(document, options.pdf);
    if (!options.json) fmt::print("{} and {}.\n", options.out.string(), page.string());
    return 0;
}

}  // namespace

Run add_projector(CLI::App& app) {
    const auto options = std::make_shared<ProjectorOptions>();
    ProjectorOptions& o = *options;
    auto* sub = add_command(
        app, "projector", "What the projector really does: gamma, colour cycle, latency; which monitor it is",
        "projector --room room.json --out projector.json --pdf projector.pdf\n"
        "  planlight projector recording --configured-ms 25 --serial X7K2 --out projector.json\n"
        "  planlight projector --simulate paper --seed 3 --light wheel-hz=120 delay-ms=12 --out projector.json\n"
        "  planlight projector --identify\n"
        "  planlight projector --show --monitor HDMI-2 --frames-hz 60 --keep recording");
    auto* recording =
        sub->add_option("recording", o.recording, "Folder with latency/, response/, cycle/ (any of them)");
    auto* simulate =
        sub->add_option("--simulate", o.simulate, "Measure the simulated room's projector instead: modern or paper")
            ->check(CLI::IsMember({"modern", "paper"}))
            ->excludes(recording);
    sub->add_option("--room", o.room,
                    "Measure the projector of this room.json with its own cameras; a white card where the patient will "
                    "be, and nobody there")
        ->excludes(recording)
        ->excludes(simulate);
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
    pdf_option(sub, o.pdf);
    sub->get_option("--pdf")->excludes(show)->excludes(identify);
    json_flag(sub, o.json);
    return [options] { return run_projector(*options); };
}

}  // namespace planlight
