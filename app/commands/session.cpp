#include <fmt/format.h>

#include "app/case_model.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/language_option.h"
#include "app/commands/session_recording.h"
#include "app/commands/surgeon_option.h"
#include "app/console.h"
#include "app/freed_memory.h"
#include "app/igtl/session_link.h"
#include "app/live/live_window.h"
#include "app/live/real_room.h"
#include "app/live/simulated_fault.h"
#include "app/live/simulated_room.h"
#include "app/session_observers.h"
#include "app/site_settings.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/case/room_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"

namespace planlight {
namespace {

constexpr const char* kLookedAt = "The last session is being looked at.";

/// What the session may go on with. What was asked for and cannot be is refused; what would merely be offered is said.
/// `rig`: null where it is not known yet.
std::optional<ResumeOffer> resume_of(const SessionOptions& options, const Case& the_case, const RigCalibration* rig) {
    if (!options.resume.empty()) {
        ResumeOffer offer = resume_offer(options.resume, the_case, rig);
        offer.at_once = true;
        return offer;
    }
    auto session = last_session(recordings_folder(options));
    if (!session) return std::nullopt;
    try {
        return resume_offer(std::move(session->last), session->recording, the_case, rig);
    } catch (const Error& why_not) {
        print_to_user(fmt::format("The last session cannot be gone on with: {}.\n", why_not.what()));
        return std::nullopt;
    }
}

/// Other systems are told by OpenIGTLink; null where nobody is.
std::unique_ptr<SessionLink> link_of(const SessionOptions& options, const Case& the_case, const SiteSettings& site) {
    if (options.igtl_port == 0) return nullptr;
    SessionLinkSettings settings;
    settings.server.port = options.igtl_port;
    settings.server.address = options.igtl_address;
    settings.names = site.openigtlink_names;
    auto link = std::make_unique<SessionLink>(the_case, settings);
    print_to_user(fmt::format(
        "Whoever connects to port {} of {} (OpenIGTLink) is told poses and what the gate says, and is given skin "
        "and plan, {}; the skin is the patient's face, and nothing is encrypted.\n",
        link->port(), options.igtl_address, settings.names ? "with their names" : "without names"));
    return link;
}

/// Who is told of a session, for as long as it runs.
struct Listeners {
    std::unique_ptr<SessionLink> link;  // a port that is taken is said before a recording is begun
    RecordedSession recorded;
    SessionObservers all;
    Listeners(const SessionOptions& options, const Case& the_case, const SiteSettings& site,
              const DrawingSettings& drawing)
        : link(link_of(options, the_case, site)), recorded(recording_of_session(options, the_case, site, drawing)) {
        warn_of_full_disks(options);
        all.add(recorded.get());
        all.add(link.get());
    }
    /// After the session: the others hear at once that it has ended, not when its report is there.
    void end(SessionWindow& window) {
        link.reset();
        recorded.end(window);
    }
};

LiveOptions live_options(const SessionOptions& options, const SiteSettings& site, Listeners& listeners) {
    LiveOptions live;
    SessionRecorder* recorder = listeners.recorded.get();
    live.observer = listeners.all.all();
    live.projector_monitor = options.projector_monitor.empty() ? site.projector_monitor : options.projector_monitor;
    live.operator_monitor = options.operator_monitor.empty() ? site.operator_monitor : options.operator_monitor;
    live.projector = projector_facts(options);
    live.autoplay = options.autoplay;
    live.idle_first_s = options.idle_first_s;
    live.json = options.json;
    live.end_after_s = options.end_after_s;
    live.screenshots = options.screenshots;
    live.keep_matches_in = matches_folder(options);
    live.recorded = listeners.recorded.of_patient();
    if (const double every = options.check_skin_every_min.value_or(site.check_skin_every_min); every > 0)
        live.skin_checks.every = from_seconds(60 * every);
    if (recorder) live.trouble = [recorder] { return recorder->trouble(); };
    return live;
}

CaseDrawing drawing_of(const SessionOptions& options, const Case& the_case, const SiteSettings& site,
                       SessionWindow& window) {
    return window.while_made("The plan is being drawn on the skin.", 0.7, [&] {
        CaseDrawing drawing(the_case, drawing_settings(site));
        drawing.settings.card = card_of(the_case, drawing.skin, options.anonymous);  // for the light of the session
        return drawing;
    });
}

int run_in_simulated_room(const SessionOptions& options, const Case& the_case, const SiteSettings& site,
                          SessionWindow& window) {
    if (options.volume.empty())
        throw Error(ExitCode::usage, "neither a room nor a simulated patient was named",
                    "Give --room room.json for real devices, or --volume VOLUME for the simulated room.");
    const Volume volume = window.while_made("The volume of the simulated patient is being read.", 0.3,
                                            [&] { return read_volume(options.volume, options.series_uid); });
    if (hash_of(volume) != the_case.volume_hash)
        throw InputError(options.volume, "this is not the volume that the case was made from",
                         "Give the volume of this case, or prepare a case from this volume.");
    simulation::RoomSettings room;
    room.preset = options.preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
    room.seed = options.seed;
    auto resume = window.while_made(kLookedAt, 0.5, [&] { return resume_of(options, the_case, nullptr); });
    const CaseDrawing drawing = drawing_of(options, the_case, site, window);
    window.window();  // throws without a display: before a recording is begun
    Listeners listeners(options, the_case, site, drawing.settings);
    LiveOptions live = live_options(options, site, listeners);
    live.resume = std::move(resume);
    const int code = run_live_simulated(
        window,
        [&](const RoomProgress& progress) {
            progress("The simulated room is being built.", std::nullopt);
            return std::make_unique<SimulatedRoom>(volume, the_case.plan, room, options.speed_mm_s, options.fault);
        },
        the_case, drawing, live);
    listeners.end(window);
    return code;
}

int run_in_room(SessionOptions options, const Case& the_case, const SiteSettings& site, SessionWindow& window) {
    const RoomFile room = read_room(options.room);
    const RigCalibration rig = read_rig(room.rig);
    if (options.projector_monitor.empty()) options.projector_monitor = room.monitor;
    if (options.projector_monitor.empty() && !room.recorded)  // a recorded room may have none
        options.projector_monitor = site.projector_monitor;
    if (options.projector_file.empty() && options.light_delay_ms < 0) options.projector_file = room.projector_file;
    auto resume = window.while_made(kLookedAt, 0.3, [&] { return resume_of(options, the_case, &rig); });
    const CaseDrawing drawing = drawing_of(options, the_case, site, window);
    window.window();  // throws without a display: before a recording is begun
    Listeners listeners(options, the_case, site, drawing.settings);
    LiveOptions live = live_options(options, site, listeners);
    live.resume = std::move(resume);
    live.projector_monitor = options.projector_monitor;
    const int code = run_live(
        window,
        [&](Projector* projector, const RoomProgress& progress) {
            return std::make_unique<RealRoom>(room, rig, projector, progress);
        },
        the_case, drawing, live);
    listeners.end(window);
    return code;
}

int run_session(const SessionOptions& options) {
    if (options.check_skin_every_min.value_or(0) > 0 && *options.check_skin_every_min < 1)
        throw Error(ExitCode::usage, "--check-skin-every is shorter than a minute",
                    "Give 1 to 60 minutes, or 0 for checks only when they are asked for.");
    hand_large_blocks_back();
    const SiteSettings site = site_with(options.surgeon);
    SessionWindow window(options.operator_monitor.empty() ? site.operator_monitor : options.operator_monitor,
                         words_of_window(options.language, site), theme_of_window(options.theme, site));
    const Case the_case =
        window.while_made("The case is being read.", 0.1, [&] { return read_case(options.case_folder); });
    if (!options.json) fmt::print("{}\n", title_of(the_case));
    return options.room.empty() ? run_in_simulated_room(options, the_case, site, window)
                                : run_in_room(options, the_case, site, window);
}

}  // namespace

Run add_session(CLI::App& app) {
    const auto options = std::make_shared<SessionOptions>();
    SessionOptions& o = *options;
    auto* sub = add_command(app, "session",
                            "Live: operator window and projector, in a room of real devices or in the simulated one",
                            "session case --room room.json");
    sub->add_option("case", o.case_folder, "Case folder")->required();
    auto* room = sub->add_option("--room", o.room, "room.json of real cameras and a real projector (see `devices`)");
    sub->add_option("--volume", o.volume,
                    "Without a room: the simulated patient, the volume that the case was made from")
        ->excludes(room);
    series_option(sub, o.series_uid);
    sub->add_option("--keep", o.keep, "Folder that keeps every match and its scan (default: CASE/registrations)");
    sub->add_option("--record", o.record,
                    "What is recorded: none, events (what happened, and some frames: at most 1 GB an hour), or all "
                    "(every frame: what `replay` needs)")
        ->capture_default_str()
        ->check(CLI::IsMember({"none", "events", "all"}));
    sub->add_option("--recordings", o.recordings, "Folder for the recording (default: CASE/recordings)");
    sub->add_option("--resume", o.resume,
                    "Recording of a session that was cut short: goes on with its last match, without a press, if "
                    "markers, rig and skin agree with it (otherwise the newest recording is offered in the window)");
    sub->add_flag("--anonymous", o.anonymous,
                  "The recording holds no names, and its pictures are blurred but for the plan's surroundings");
    sub->add_flag("--no-report", o.no_report,
                  "No report at the end; otherwise page (.html, .json) and PDF are written beside the recording");
    preset_option(sub, o.preset)->excludes(room);
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
    sub->add_option("--operator-name", o.operator_name,
                    "Who operates, for the recording and its report (default: the site's, else the account's name)");
    sub->add_option("--check-skin-every", o.check_skin_every_min,
                    "While the patient is followed, minutes (1 to 60) from one check of the skin to the next, each a "
                    "second of stripes that is announced first (0: only when asked; default: the site's, else 0)")
        ->check(CLI::Range(0.0, 60.0));
    surgeon_option(sub, o.surgeon);
    language_option(sub, o.language);
    theme_option(sub, o.theme);
    sub->add_option("--seed", o.seed, "Of the simulated room")->capture_default_str()->excludes(room);
    sub->add_option("--speed-mm-s", o.speed_mm_s, "Peak speed of the head")
        ->capture_default_str()
        ->excludes(room)
        ->check(CLI::Range(0.0, 500.0));
    sub->add_option("--fault", o.fault, "To see what it looks like: begins some seconds after the light is ALIGNED")
        ->excludes(room)
        ->check(CLI::IsMember(simulated_faults()));
    auto* igtl = sub->add_option("--igtl", o.igtl_port,
                                 "Tell other systems (3D Slicer) by OpenIGTLink on this port: T_ini, T_cur, T_global, "
                                 "what the gate says, its error, skin and plan; nothing is received")
                     ->check(CLI::Range(1, 65535));
    sub->add_option("--igtl-address", o.igtl_address,
                    "The network card that it listens on, as a number (0.0.0.0: all of them)")
        ->capture_default_str()
        ->needs(igtl);
    sub->add_flag(
        "--autoplay", o.autoplay,
        "Scan, register and track by itself until DARK or Stop is pressed; that the light is right is said in the "
        "simulated room only");
    sub->add_option("--idle-first-s", o.idle_first_s,
                    "With --autoplay: wait so long before the first press; --json then says what the window cost");
    sub->add_option("--end-after-s", o.end_after_s, "Close after this many seconds of tracking");
    sub->add_option("--screenshots", o.screenshots, "Folder for screenshots of every step");
    json_flag(sub, o.json);
    return [options] { return run_session(*options); };
}

}  // namespace planlight
