#include <fmt/format.h>

#include <algorithm>
#include <iostream>

#include "app/commands/commands.h"
#include "app/commands/light_source.h"
#include "app/console.h"
#include "app/live/identify_monitors.h"
#include "app/live/show_light.h"
#include "app/report/projector_report.h"
#include "planning_io/safe_write.h"
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
    if (!options.keep.empty()) std::filesystem::create_directories(options.keep);
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
        throw InputError(options.recording,
                         "holds no recording of light (latency/, response/ or cycle/, each with its light.json)",
                         "Record one; registration/projector/README.md says how.");
}

template <class Result>
void throw_if_refused(const std::optional<Result>& result, const char* what) {
    if (result && result->refusal)
        throw CheckFailedError(fmt::format("{}: {}", what, result->refusal->reason), result->refusal->remedy);
}

}  // namespace

int run_projector(const ProjectorOptions& options) {
    if (options.identify) return identify_monitors(options);
    if (options.show) return show_light(options);
    if (options.recording.empty() == options.simulate.empty())
        throw InputError({}, "there is nothing to measure, or two things",
                         "Give a folder of recorded light, or --simulate, --show or --identify.");
    ProjectorReport report;
    report.made_on = today();
    report.serial = options.serial;
    report.monitor = options.monitor;
    if (options.simulate.empty())
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
    if (options.out.empty()) return 0;
    Path page = options.out;
    page.replace_extension(".html");
    write_safely(options.out, text);
    write_projector_html(report, page);
    if (!options.json) fmt::print("{} and {}.\n", options.out.string(), page.string());
    return 0;
}

}  // namespace planlight
