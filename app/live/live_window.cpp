#include "app/live/live_window.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "app/case_model.h"
#include "app/console.h"
#include "app/live/autoplay.h"
#include "app/live/dark_at_the_end.h"
#include "app/live/light_keeper.h"
#include "app/live/live_session.h"
#include "app/live/projector_keeper.h"
#include "app/live/projector_watch.h"
#include "app/live/silent_session.h"
#include "app/live/step_pictures.h"
#include "app/live/window_meter.h"
#include "app/windows/operator_window.h"
#include "planning_io/types/error.h"
#include "projection/monitor/projector_window.h"

namespace planlight {
namespace {

constexpr double kLongestRest_s = 0.03;                               ///< between two looks at the session
constexpr Instant kSessionPatience = std::chrono::milliseconds(500);  ///< with a session that has light on the patient
/// The same where nothing is real: such a room computes longer than a real one exposes.
constexpr Instant kSimulatedPatience = std::chrono::milliseconds(2500);

/// The monitor for the light: as asked for, else the first that is not the primary one; empty when there is only one.
std::string light_monitor(const LiveOptions& options) {
    if (!options.projector_monitor.empty()) return options.projector_monitor;
    for (const auto& monitor : list_monitors())
        if (!monitor.primary) return monitor.name;
    return {};
}

/// Refuses a monitor that is not the projector which was measured.
void check_monitor(const std::string& name, const ProjectorFacts& facts) {
    const auto monitors = list_monitors();
    for (std::size_t i = 0; i < monitors.size(); ++i) {
        const Monitor& m = monitors[i];
        if (m.name != name && std::to_string(i) != name) continue;
        const auto other = [&](const std::string& what, const std::string& is, const std::string& was) {
            throw CheckFailedError(
                fmt::format("the projector on {} is not the one that was measured on {}: its {} is {}, was {}", m.name,
                            facts.made_on, what, is, was),
                "Connect that projector, set its resolution, or measure this one with `planlight projector`.");
        };
        if (facts.width > 0 && (m.width != facts.width || m.height != facts.height))
            other("resolution", fmt::format("{} x {}", m.width, m.height),
                  fmt::format("{} x {}", facts.width, facts.height));
        if (!facts.serial.empty() && !m.serial.empty() && m.serial != facts.serial)
            other("serial", m.serial, facts.serial);
        if (!facts.monitor.empty() && m.name != facts.monitor) other("monitor", m.name, facts.monitor);
    }
}

/// The light follows the patient, or is about to; a scan's does not.
bool follows(const OperatorModel& model) {
    return model.light_on && model.may_light_item && !model.light_stays;
}

/// And the light of that moment beside it.
void take_pictures(StepPictures& pictures, OperatorWindow& window, const OperatorModel& model,
                   const LiveSession& session) {
    const bool dark = model.status.kind == StatusKind::dark;
    if (follows(model) && !model.figures.delay_to_light_ms && !dark) return;  // the light is still being made
    const std::string taken = pictures.take(window, model);
    const auto light = taken.empty() ? nullptr : session.light().picture;
    if (!light) return;
    // Also of a session that does not answer: what it ordered last has expired.
    keep_or_warn(dark ? RgbImage(light->width, light->height) : *light, pictures.folder() / ("light-" + taken));
}

/// A projector that is lost makes the session dark once; match and markers are kept.
void tell_of_projector(const ProjectorKeeper& projector, LiveSession& session, ProjectorWatch& watch,
                       Autoplay& autoplay, OperatorModel& model) {
    if (watch.look(projector.problem(), projector.starts())) {
        autoplay.projector_lost();
        session.post(OperatorAction::dark, AskedBy::lost_projector);
        session.look_before_light();
        model = session.model();
    }
    watch.put_into(model);
}

/// What of the patient is recorded; null: nothing.
const char* words_of(PatientRecorded recorded) {
    switch (recorded) {
        case PatientRecorded::with_face:
            return "This session is recorded: its pictures show the patient's face, and only this account can read "
                   "them.";
        case PatientRecorded::blurred:
            return "This session is recorded without names, and blurred but for the plan's surroundings.";
        case PatientRecorded::no:
            break;
    }
    return nullptr;
}

/// In the banner before anything is begun, and on the page of evidence all the time.
void tell_of_recording(PatientRecorded recorded, bool begun, OperatorModel& model) {
    const char* const words = words_of(recorded);
    if (words == nullptr) return;
    model.evidence.emplace_back(words);
    if (!begun && model.status.kind == StatusKind::ready) model.status.details.emplace_back(words);
}

/// Light that nobody watches over goes out: a window that is minimised or on another workspace shows no banner and
/// hears no key. That it did so is said until the next press.
class WindowPutAway {
public:
    /// True where there must be no light now.
    bool look(const OperatorWindow& window, bool light_on) {
        if (!window.put_away()) return false;
        went_dark_ = went_dark_ || light_on;
        return true;
    }
    void pressed() { went_dark_ = false; }
    void put_into(OperatorModel& model) const {
        if (went_dark_)
            model.status.details.insert(model.status.details.begin(),
                                        "It went dark as this window was minimised or on another workspace.");
    }

private:
    bool went_dark_ = false;
};

/// What a look at the session counts as.
WindowMeter::Phase phase_of(const OperatorModel& model) {
    if (follows(model)) return WindowMeter::Phase::following;
    return model.next == OperatorAction::none ? WindowMeter::Phase::other : WindowMeter::Phase::idle;
}

}  // namespace

SessionWindow::SessionWindow(const std::string& operator_monitor, std::shared_ptr<const Words> words, ThemeKind theme)
    : monitor_(operator_monitor), words_(std::move(words)), theme_(theme) {
    if (!display_is_there()) return;
    window();
    show("Planlight starts.", 0);
}

OperatorWindow& SessionWindow::window() {
    WindowSettings settings;
    settings.words = words_;
    settings.theme = theme_;
    if (!monitor_.empty()) settings.monitor = monitor_;
    if (!window_) window_ = std::make_unique<OperatorWindow>(settings);
    return *window_;
}

void SessionWindow::show(const std::string& words, double share, const SaidMeanwhile& said) {
    if (!window_) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return;
    }
    OperatorModel model;
    model.case_title = "Planlight";
    model.status = {StatusKind::waiting, words, {said.detail}, share};
    for (auto* button : {&model.scan, &model.do_register, &model.track, &model.stop}) *button = {false, said.no_press};
    model.left.note = model.right.note = said.no_picture;
    if (window_->frame(model) == OperatorAction::quit) closed_ = true;
    window_->rest(kLongestRest_s);
}

bool display_is_there() {
    return std::getenv("DISPLAY") != nullptr && *std::getenv("DISPLAY") != '\0';
}

namespace {

/// The windows' loop, until the operator window is closed; `projector` is null where there is none. Dark afterwards,
/// also while the session's thread is still at something.
int run_windows(OperatorWindow& window, LiveSession& session, ProjectorKeeper* projector, const LiveOptions& options,
                Autoplay autoplay, WindowMeter& meter) {
    const DarkAtTheEnd dark(session, projector);
    ProjectorWatch watch(projector ? projector->starts() : 0);
    StepPictures pictures(options.screenshots, "operator");
    std::optional<std::chrono::steady_clock::time_point> projecting_since;
    note_end_signals();
    WindowPutAway put_away;
    bool begun = false;  // by a press
    while (!asked_to_end()) {
        OperatorModel model = session.model();
        say_silence(model, session.projecting(), SteadyClock().now() - session.alive_at(),
                    model.room_kind == RoomKind::real ? kSessionPatience : kSimulatedPatience);
        if (projector) tell_of_projector(*projector, session, watch, autoplay, model);
        put_away.put_into(model);
        if (model.light_on && window.keyboard_is_elsewhere())
            model.status.details.insert(model.status.details.begin(),
                                        "Another window has the keyboard: no key or pedal makes it dark. Click here.");
        tell_of_recording(options.recorded, begun, model);
        if (const std::string trouble = options.trouble ? options.trouble() : ""; !trouble.empty())
            model.status.details.push_back(trouble);
        if (const std::string not_kept = session.not_kept().in_the_banner; !not_kept.empty())
            model.status.details.push_back(not_kept);
        const auto frame_began = std::chrono::steady_clock::now();
        const OperatorAction action = window.frame(model);
        const double rest_s = rest_after(std::chrono::steady_clock::now() - frame_began);
        const bool unseen = put_away.look(window, model.light_on);
        // Light that stays obeys no press; what is ordered beside it does.
        if (unseen && model.light_on && (!model.light_stays || session.projecting())) {
            session.post(OperatorAction::dark, AskedBy::program);
            if (projector) projector->go_dark();
            autoplay.pressed(OperatorAction::dark);  // by whoever put the window away
        }
        if (projector) {
            projector->window_lives();
            projector->session_lives(session.alive_at());
        }
        if (action == OperatorAction::quit) break;
        autoplay.pressed(action);
        if (action != OperatorAction::none) watch.pressed(), put_away.pressed(), begun = true;
        // Landmarks that stand in the window count for every match of their scan: a match that they refuse stays
        // refused.
        if (action == OperatorAction::do_register || action == OperatorAction::use_landmarks)
            window.say(session.post_find_patient(window.landmarks()));
        else if (action == OperatorAction::light_item || action == OperatorAction::hide_item ||
                 action == OperatorAction::show_item)
            window.say(session.post_item(action, window.item_wanted()));
        else
            window.say(session.post(action));
        // After the post: what the session hands over from now on is no light any more.
        if (projector && (action == OperatorAction::dark || action == OperatorAction::stop)) projector->go_dark();
        if (options.autoplay && meter.idle_s() >= options.idle_first_s) {
            const OperatorAction by_itself = autoplay.next(model);
            session.post(by_itself, AskedBy::program);
            begun = begun || by_itself != OperatorAction::none;
        }
        take_pictures(pictures, window, model, session);
        session.rethrow_fault();
        window.rest(rest_s);
        meter.note(phase_of(model), window.frames_drawn());
        const auto now = std::chrono::steady_clock::now();
        if (session.projecting() && !projecting_since) projecting_since = now;
        if (options.end_after_s > 0 && projecting_since &&
            now - *projecting_since > std::chrono::duration<double>(options.end_after_s))
            break;
    }
    session.rethrow_fault();  // also one of the moment in which the window ended
    return 0;
}

/// What the disk did not take; how late the light was and what the window cost, for whoever asked, and for the log.
int told_at_the_end(int code, const LiveSession& session, const WindowMeter& meter, const LiveOptions& options) {
    const UpdateLatency latency = session.latency();
    if (options.json) {
        std::string json = latency.json();
        json.resize(json.find_last_of('}'));
        std::cout << json.substr(0, json.find_last_not_of('\n') + 1) << ",\n  \"window\": " << meter.json() << "\n}\n"
                  << std::flush;
    } else if (latency.lit > 0) {
        std::cout << latency.sentence() << ".\n";
    }
    if (const std::string not_kept = session.not_kept().with_its_folder; !not_kept.empty()) warn(not_kept);
    for (const std::string& sentence : {latency.sentence(), meter.sentence()})
        if (!sentence.empty()) log_line(sentence);
    return code;
}

ProjectorKeeperSettings keeper_settings(const LiveOptions& options) {
    ProjectorKeeperSettings settings;
    settings.process.light_delay = options.projector.light_delay.value_or(settings.process.light_delay);
    return settings;
}

}  // namespace

int run_live_simulated(SessionWindow& screen, MakeRoom make_room, const Case& the_case, const CaseDrawing& drawing,
                       const LiveOptions& options) {
    OperatorWindow& window = screen.window();
    if (screen.closed()) return 0;
    std::unique_ptr<ProjectorKeeper> projector;
    if (const std::string monitor = light_monitor(options); !monitor.empty()) {
        check_monitor(monitor, options.projector);
        ProjectorKeeperSettings settings = keeper_settings(options);
        settings.session_patience = kSimulatedPatience;
        projector = std::make_unique<ProjectorKeeper>(monitor, settings);
    }
    LiveSession session(std::move(make_room), the_case, drawing, options.keep_matches_in, options.observer,
                        options.resume, options.skin_checks);
    if (projector) projector->set_permission([&session] { return session.light_permitted(); });
    std::unique_ptr<LightKeeper> light;  // dark and gone before the session is
    if (projector) light = std::make_unique<LightKeeper>(*projector, session);
    WindowMeter meter;
    const int code = run_windows(window, session, projector.get(), options,
                                 Autoplay(true, options.resume && options.resume->at_once), meter);
    return told_at_the_end(code, session, meter, options);
}

int run_live(SessionWindow& screen, const MakeRoomWith& make_room, const Case& the_case, const CaseDrawing& drawing,
             const LiveOptions& options) {
    OperatorWindow& window = screen.window();
    if (screen.closed()) return 0;
    std::unique_ptr<ProjectorKeeper> projector;
    if (!options.projector_monitor.empty()) {
        check_monitor(options.projector_monitor, options.projector);
        projector = std::make_unique<ProjectorKeeper>(options.projector_monitor, keeper_settings(options));
    }
    LiveSession session([&](const RoomProgress& progress) { return make_room(projector.get(), progress); }, the_case,
                        drawing, options.keep_matches_in, options.observer, options.resume, options.skin_checks);
    if (projector) projector->set_permission([&session] { return session.light_permitted(); });
    WindowMeter meter;
    const int code = run_windows(window, session, projector.get(), options,
                                 Autoplay(false, options.resume && options.resume->at_once), meter);
    return told_at_the_end(code, session, meter, options);
}

void show_model(const OperatorModel& model, FitView view, const WindowSettings& settings) {
    OperatorWindow window(settings);
    window.set_fit_view(view);
    while (window.frame(model) != OperatorAction::quit) window.rest(kLongestRest_s);
}

std::vector<PointPair> click_landmarks(const OperatorModel& model, const std::vector<PointPair>& already,
                                       const WindowSettings& settings) {
    OperatorWindow window(settings);
    window.open_landmarks(already);
    for (;;) {
        const OperatorAction action = window.frame(model);
        if (action == OperatorAction::quit || action == OperatorAction::use_landmarks) return window.landmarks();
        window.rest(kLongestRest_s);
    }
}

}  // namespace planlight
