#include "app/commands/session_recording.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "app/console.h"
#include "app/disk_room.h"
#include "app/end_signals.h"
#include "app/recording/anonymous.h"
#include "app/recording/recording_head.h"
#include "app/report/html_page.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/types/error.h"
#include "projection/light_gate.h"
#include "projection/monitor/projector_process.h"

namespace planlight {
namespace {

/// What this session was told to do, for who looks at its recording later. It names nobody.
std::string settings_text(const SessionOptions& options, const SiteSettings& site) {
    const LightGateSettings gate;
    const bool simulated = options.room.empty();
    const std::string& monitor =
        simulated && options.projector_monitor.empty() ? site.projector_monitor : options.projector_monitor;
    nlohmann::ordered_json json{{"record", options.record},
                                {"anonymous", options.anonymous},
                                {"autoplay", options.autoplay},
                                {"resumed", !options.resume.empty()},
                                {"igtl_port", options.igtl_port},
                                {"projector_monitor", monitor},
                                {"gate",
                                 {{"warn_mm", gate.warn_mm},
                                  {"stop_mm", gate.stop_mm},
                                  {"least_seen_share", gate.least_seen_share},
                                  {"least_seen_of_item", gate.least_seen_of_item},
                                  {"warn_unnoticed_mm", gate.warn_unnoticed_mm},
                                  {"fresh_s", seconds(gate.fresh)},
                                  {"verified_for_s", seconds(gate.verified_for)}}},
                                {"site",
                                 {{"units", site.units},
                                  {"surgeon_side", site.surgeon_side},
                                  {"language", options.language.empty() ? site.language : options.language},
                                  {"theme", options.theme.empty() ? site.theme : options.theme},
                                  {"openigtlink_names", site.openigtlink_names}}}};
    if (!simulated) {  // the simulated projector says itself when its light comes
        const auto known = projector_facts(options).light_delay;
        json["light_delay_ms"] = 1e3 * seconds(known.value_or(ProjectorProcessSettings{}.light_delay));
        json["light_delay_from"] = options.light_delay_ms >= 0 ? "option" : known ? "projector file" : "default";
    }
    if (simulated)
        json["simulated"] = {{"preset", options.preset},
                             {"seed", options.seed},
                             {"speed_mm_s", options.speed_mm_s},
                             {"fault", options.fault}};
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

RecordingHead head_of_session(const SessionOptions& options, const Case& the_case, const SiteSettings& site,
                              const DrawingSettings& drawing) {
    RecordingHead head = recording_head(the_case, options.case_folder, record_mode_of(options.record), drawing);
    const std::string& named = options.operator_name.empty() ? site.operator_name : options.operator_name;
    if (!named.empty()) head.operator_name = named, head.operator_named = true;
    head.settings = settings_text(options, site);
    return head;
}

/// All that an anonymous recording of this session must not say.
NamesLeftOut names_left_out(const SessionOptions& options, const Case& the_case, const RecordingHead& head) {
    NamesLeftOut names(the_case);
    for (const std::string& name : {head.operator_name, operator_name(), head.computer}) names.add_person(name);
    std::error_code ignored;
    for (const Path& place : {head.case_folder, options.case_folder, options.recordings, options.keep, options.volume,
                              options.room.parent_path(), options.resume.parent_path(), options.screenshots}) {
        if (place.empty()) continue;
        for (const Path& written : {place, std::filesystem::absolute(place, ignored).lexically_normal(),
                                    std::filesystem::weakly_canonical(place, ignored)})
            names.add_place(written);
    }
    return names;
}

}  // namespace

void RecordedSession::end(SessionWindow& window) {
    window.stay();
    end(
        [&](const std::function<std::string()>& finish) {
            return window.while_made(
                "The recording is being ended.", 0.2, finish,
                {"A slow disk is given ten seconds.", "the session is over", "the session is over"});
        },
        [&](const std::function<ReportBeside()>& write) {
            return window.while_made(
                "The report of this session is being written.", 0.5, write,
                {"Close the window to end without it.", "the session is over", "the session is over"});
        },
        [&] { return window.closed(); });
}

void RecordedSession::end(const Meanwhile<std::string>& finishing, const Meanwhile<ReportBeside>& reporting,
                          const Closed& closed) noexcept {
    if (!recorder_) return;
    const std::unique_ptr<SessionRecorder> recorder = std::move(recorder_);
    try {
        const auto finish = [&] { return recorder->finish(); };
        if (const std::string lacks = finishing ? finishing(finish) : finish(); !lacks.empty()) warn(lacks);
    } catch (const std::exception& fault) {
        warn(std::string("The recording could not be ended: ") + fault.what());
    }
    if (report_ && recorder->room_was_entered()) report(reporting, closed);
}
void RecordedSession::report(const Meanwhile<ReportBeside>& meanwhile, const Closed& closed) noexcept {
    try {
        const auto go_on = [&closed, before = times_asked_to_end()] {
            if ((closed && closed()) || times_asked_to_end() != before)
                throw std::runtime_error("it was ended before it was done");
        };
        const auto write = [&] { return write_report_beside(file_, go_on); };
        const ReportBeside report = meanwhile ? meanwhile(write) : write();
        print_to_user(fmt::format(
            "{}\nThe report of this session: {} and {}. {}, as the recording does.\n", report.verdict,
            report.page.string(), report.pdf.string(),
            anonymous_ ? "It names nobody, and shows what lies round the plan alone" : "It shows the patient's face"));
    } catch (const std::exception& fault) {
        warn(
            fmt::format("The report of this session could not be written: {}. The recording is there; write it with "
                        "`planlight report {}`.",
                        fault.what(), file_.string()));
    }
}

void warn_of_full_disks(const SessionOptions& options) {
    const bool records = record_mode_of(options.record) != RecordMode::none;
    for (const std::string& warning :
         warnings_of_full_disks(records ? std::optional(disk_room_of(recordings_folder(options))) : std::nullopt,
                                disk_room_of(matches_folder(options))))
        warn(warning);
}

RecordedSession recording_of_session(const SessionOptions& options, const Case& the_case, const SiteSettings& site,
                                     const DrawingSettings& drawing) {
    const RecordMode mode = record_mode_of(options.record);
    if (mode == RecordMode::none) {
        print_to_user("This session is not recorded, and there will be no report of it.\n");
        return {};
    }
    if (options.anonymous && mode == RecordMode::all)
        throw Error(ExitCode::usage, "what is recorded to be replayed cannot be anonymous",
                    "Give --record events with --anonymous.");
    const Path file = new_recording_name(recordings_folder(options));
    auto sink = std::make_unique<RecordingFile>(file);
    const RecordingHead head = head_of_session(options, the_case, site, drawing);
    const double free_gb = disk_room_of(file.parent_path()).free_gb;
    const std::string free =
        free_gb < 10 ? fmt::format("{:.0f} MB", 1000 * free_gb) : fmt::format("{:.0f} GB", free_gb);
    if (options.anonymous) {
        print_to_user(fmt::format(
            "Recorded in {}: what happens and some of the frames, without names, and blurred but for the plan's "
            "surroundings, at most 1 GB an hour; {} are free. Only {} can read it; no later session can go on "
            "with its match. Matches with the scan of the face are still kept in {}.\n",
            file.string(), free, operator_name(), matches_folder(options).string()));
        const NamesLeftOut names = names_left_out(options, the_case, head);
        RecordingHead nameless = without_names(head);
        nameless.settings = names.out_of(head.settings);
        return {std::make_unique<SessionRecorder>(std::move(sink), nameless, RecordingWriterSettings{},
                                                  FrameChoiceSettings{}, names),
                file, !options.no_report, true};
    }
    print_to_user(fmt::format(
        "Recorded in {}: {}; {} are free. It shows the patient's face, and only {} can read it.\n", file.string(),
        mode == RecordMode::events ? "what happens and some of the frames, at most 1 GB an hour"
                                   : "every frame, about 23 GB an hour in the paper's room",
        free, operator_name()));
    return {std::make_unique<SessionRecorder>(std::move(sink), head), file, !options.no_report, false};
}

}  // namespace planlight
