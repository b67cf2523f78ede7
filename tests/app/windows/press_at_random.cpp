// DARK at random moments of scan, match, verification, tracking and checks of the skin, in the pixels of the monitor.
// Run by two_monitors.sh: `press_at_random FOLDER`, with PRESSES how often DARK is pressed (default 20), SEED, and
// FAULTS=1 to stop and kill the projector process now and then. Between the presses of DARK other buttons are pressed
// at random by two threads, and the model and the light are read as the window reads them; all of it is recorded. Exit
// code 0 when each light was dark in 100 ms and stayed so, and the banner said so at once.
//
// The same source, with the threads of the product, is built with ThreadSanitizer as race_session.
#include <fmt/format.h>
#include <signal.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <random>
#include <thread>
#include <vector>

#include "app/live/light_keeper.h"
#include "app/live/live_session.h"
#include "app/live/simulated_room.h"
#include "app/prepare_case.h"
#include "app/recording/session_recorder.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "root_window.h"
#include "tests/support/test_data.h"

// Last, for its macros.
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#undef Status

namespace {

using namespace planlight;
using namespace std::chrono_literals;
using test::expect;

constexpr Instant kLongest = 100ms, kWatched = 150ms;

int number_from(const char* name, int otherwise) {
    const char* const text = std::getenv(name);
    return text == nullptr ? otherwise : std::atoi(text);
}

/// The whole of a monitor, as a person sees it.
class Eye {
public:
    explicit Eye(const Monitor& monitor) : monitor_(monitor) {}
    ~Eye() { XCloseDisplay(display_); }
    bool lit() const {
        XImage* const image = XGetImage(display_, DefaultRootWindow(display_), monitor_.x, monitor_.y,
                                        static_cast<unsigned>(monitor_.width), static_cast<unsigned>(monitor_.height),
                                        AllPlanes, ZPixmap);
        bool lit = false;
        for (int y = 0; y < monitor_.height && !lit; ++y) {
            const auto* row = reinterpret_cast<const std::uint32_t*>(image->data + y * image->bytes_per_line);
            lit = std::any_of(row, row + monitor_.width, [](std::uint32_t p) { return (p & 0xFFFFFF) != 0; });
        }
        XDestroyImage(image);
        return lit;
    }

private:
    Monitor monitor_;
    Display* display_ = XOpenDisplay(nullptr);
};

/// How far a person goes before DARK is pressed.
enum class Goal { scan, match, track, verify, check_skin };

Goal any_goal(std::mt19937& random) {
    constexpr std::array goals{Goal::scan,  Goal::match,  Goal::track,  Goal::track,      Goal::track,
                               Goal::track, Goal::verify, Goal::verify, Goal::check_skin, Goal::track};
    return goals[std::uniform_int_distribution<std::size_t>(0, goals.size() - 1)(random)];
}

/// The press that leads on to the goal, by what the window offers; `none` when it is reached or something runs.
OperatorAction press_towards(Goal goal, const OperatorModel& model) {
    const StatusKind now = model.status.kind;
    if (now == StatusKind::scanning || now == StatusKind::matching) return OperatorAction::none;
    if (goal == Goal::scan) return model.scan.enabled ? OperatorAction::scan : OperatorAction::none;
    if (goal == Goal::match && model.do_register.enabled) return OperatorAction::do_register;
    if (model.stop.enabled) {  // the plan is lit
        if (goal == Goal::verify && model.confirm) return OperatorAction::confirm;
        return goal == Goal::check_skin && model.check_skin ? OperatorAction::check_skin : OperatorAction::none;
    }
    if (model.confirm) return OperatorAction::confirm;
    if (model.track.enabled) return OperatorAction::track;
    return model.do_register.enabled ? OperatorAction::do_register : OperatorAction::scan;
}

bool reached(Goal goal, const OperatorModel& model) {
    if (goal == Goal::scan) return model.status.kind == StatusKind::scanning;
    if (goal == Goal::match) return model.status.kind == StatusKind::matching;
    return model.stop.enabled;
}

struct Tally {
    std::vector<double> dark_ms;
    int lit_before = 0, late = 0, came_back = 0, banner_wrong = 0, buttons_wrong = 0;
};

/// Watches from a press of DARK on; `quiet`: nothing else is pressed meanwhile.
void watch_dark(const Eye& eye, LiveSession& session, ProjectorKeeper& keeper, Tally& tally) {
    const SteadyClock clock;
    tally.lit_before += eye.lit();
    const Instant pressed = clock.now();
    keeper.go_dark();
    session.post(OperatorAction::dark);
    tally.banner_wrong += session.model().status.kind != StatusKind::dark;
    Instant dark_since = Instant::max();  // of the look that first found it dark, when that ended
    while (clock.now() - pressed < kLongest + kWatched || dark_since == Instant::max()) {
        if (eye.lit())
            dark_since = Instant::max();
        else if (dark_since == Instant::max())
            dark_since = clock.now();
        keeper.window_lives();
        keeper.session_lives(session.alive_at());
        if (clock.now() - pressed > 5s) break;
        std::this_thread::sleep_for(1ms);
    }
    const Instant took = dark_since == Instant::max() ? Instant(5s) : dark_since - pressed;
    tally.dark_ms.push_back(1000 * seconds(took));
    tally.late += took > kLongest;
    tally.buttons_wrong += session.model().confirm && !session.projecting() && session.model().scene.light != nullptr;
}

int run(const std::string& monitor_name, const Monitor& monitor) {
    const Volume volume = read_volume(*test::example_patient());
    const Preparation prepared = prepare_case(
        volume, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {}, {}, "2001-10-14");
    const CaseDrawing drawing(prepared.prepared);
    const unsigned seed = static_cast<unsigned>(number_from("SEED", 1));
    const bool slow = number_from("SLOW", 0) != 0;  // with ThreadSanitizer: times are not judged
    ProjectorKeeperSettings keeping;
    keeping.session_patience = std::chrono::milliseconds(2500);  // the simulated room computes long
    if (slow) {
        keeping.process.start_allowed = 300s;
        keeping.process.lease = keeping.process.silence_allowed = keeping.process.work_allowed = 20s;
    }
    ProjectorKeeper keeper(monitor_name, keeping);
    simulation::RoomSettings room;
    room.preset = simulation::Preset::paper;
    room.seed = seed;
    const test::TemporaryFolder folder;
    SessionRecorder recorder(std::make_unique<RecordingFile>(folder.path() / "session.plrec"),
                             recording_head(prepared.prepared, {}, RecordMode::all, {}));
    SkinCheckScheduleSettings soon;  // and what the session does by itself
    soon.every = 1s;
    soon.announced_for = soon.still_for = 200ms;
    LiveSession session(
        [&](const RoomProgress&) { return std::make_unique<SimulatedRoom>(volume, prepared.prepared.plan, room, 20); },
        prepared.prepared, drawing, {}, &recorder, {}, soon);
    const LightKeeper copy(keeper, session);
    const Eye eye(monitor);
    std::mt19937 random(seed);
    std::atomic<bool> ending{false}, quiet{false};
    std::jthread other([&] {  // a second reader, and now and then a second hand
        std::mt19937 own(seed + 1);
        while (!ending) {
            const OperatorModel model = session.model();
            if (!quiet && std::uniform_int_distribution<int>(0, 60)(own) == 0)
                session.post(press_towards(any_goal(own), model));
            static_cast<void>(session.light());
            static_cast<void>(keeper.problem());
            std::this_thread::sleep_for(std::chrono::milliseconds(std::uniform_int_distribution<int>(5, 100)(own)));
        }
    });
    Tally tally;
    const int presses = number_from("PRESSES", 20);
    const bool faults = number_from("FAULTS", 0) != 0;
    for (int press = 0; press < presses; ++press) {
        const Goal goal = any_goal(random);
        const auto give_up = std::chrono::steady_clock::now() + (slow ? 120s : 15s);
        auto until = give_up;
        while (std::chrono::steady_clock::now() < until) {
            const OperatorModel model = session.model();
            session.rethrow_fault();
            keeper.window_lives();
            keeper.session_lives(session.alive_at());
            if (until == give_up && reached(goal, model))
                until = std::chrono::steady_clock::now() +
                        std::chrono::milliseconds(std::uniform_int_distribution<int>(0, 1200)(random));
            session.post(press_towards(goal, model));
            std::this_thread::sleep_for(30ms);
        }
        if (faults && std::uniform_int_distribution<int>(0, 9)(random) == 0)
            keeper.disturb(random() % 2 == 0 ? SIGSTOP : SIGKILL);
        quiet = true;
        watch_dark(eye, session, keeper, tally);
        quiet = false;
    }
    ending = true;
    std::sort(tally.dark_ms.begin(), tally.dark_ms.end());
    const auto share = [&](double s) {
        return tally.dark_ms[static_cast<std::size_t>(s * static_cast<double>(tally.dark_ms.size() - 1))];
    };
    expect(slow || tally.late == 0,
           fmt::format("{} presses of DARK, {} while lit: dark after {:.0f} ms (median), {:.0f} ms (95 %), {:.0f} ms "
                       "(worst); later than {:.0f} ms: {}",
                       presses, tally.lit_before, share(0.5), share(0.95), share(1), 1000 * seconds(kLongest),
                       tally.late));
    expect(tally.banner_wrong == 0,
           fmt::format("the banner says DARK in the next frame: not {} times", tally.banner_wrong));
    return test::failures() == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 4 && std::string(argv[1]) == "projector-window")
        return serve_projector(argv[3], kProjectorBell, kProjectorMailbox);
    if (!test::example_patient()) return 77;
    // The workers of a library that is not built with ThreadSanitizer look like races to it.
    const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    try {
        const std::vector<Monitor> monitors = list_monitors();
        if (monitors.size() != 2) return 2;
        return run(monitors[1].name, monitors[1]);
    } catch (const Error& error) {
        fmt::print(stderr, "{} {}\n", error.what(), error.remedy);
        return static_cast<int>(error.exit_code);
    }
}
