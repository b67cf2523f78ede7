// Faults of a real room, each begun at a random moment of a running session: how long until the monitor is dark in its
// pixels, and until the operator's window says why, by the wall clock. The simulated room is served as hardware (two
// GigE Vision cameras, the light of the second monitor), the session is the one of `planlight session --room`. Run by
// two_monitors.sh: `measure_wire_faults FOLDER`, with PLANLIGHT the program (for its projector process), ROUNDS how
// often each fault is tried (default 1) and ONLY a part of the name of the faults to try. Prints a table. Exit code 0
// when every fault was dark within 300 ms, named, and over again when the fault was; 77: skipped.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <thread>

#include "app/live/live_session.h"
#include "app/live/projector_keeper.h"
#include "app/live/real_room.h"
#include "app/prepare_case.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/statistics.h"
#include "planning_io/volume/read_volume.h"
#include "projection/monitor/monitor_picture.h"
#include "root_window.h"
#include "screen_light.h"
#include "served_room_test.h"

namespace {

using namespace planlight;
using namespace std::chrono_literals;
using test::expect;

constexpr Instant kLongest = 300ms;  // to darkness
constexpr Instant kDark = 150ms;     // of no light at all: two pictures' lives, so that a late picture is no darkness
constexpr Instant kLasts = 2500ms;   // each fault, at least

std::string words_of(const Status& status) {
    std::string words = status.headline;
    for (const std::string& detail : status.details) words += " " + detail;
    return words;
}

/// The room as hardware, and the session in it with the operator's two hands.
class Operation {
public:
    Operation(const Volume& volume, const Preparation& prepared, const std::string& program)
        : the_case_(prepared.prepared),
          drawing_(the_case_),
          monitor_("DUMMY1"),
          rig_(volume, points_of(the_case_.plan), room_settings(prepared.threshold)) {
        const simulation::ServeSettings serve = test::cameras_with_their_own_clocks();
        served_ = std::make_unique<simulation::ServedRoom>(
            rig_, [this] { return look(); }, serve);
        room_.together = true;
        room_.left.device = "SIM-L";
        room_.right.device = "SIM-R";
        room_.left.exposure_ms = room_.right.exposure_ms = 10;
        room_.left.transfer_ms = room_.right.transfer_ms = 1e3 * seconds(serve.latency);
        room_.left.global_shutter = room_.right.global_shutter = true;
        calibration_ = rig_.calibration();
        calibration_.serials = {"SIM-L", "SIM-R", ""};
        ProjectorKeeperSettings keeper;
        keeper.process.program = program;
        keeper.process.light_delay = 70ms;  // the lamp's 25, and what software OpenGL takes to paint
        projector_ = std::make_unique<ProjectorKeeper>("DUMMY1", keeper);
        session_ = std::make_unique<LiveSession>(
            [this](const RoomProgress&) { return std::make_unique<RealRoom>(room_, calibration_, projector_.get()); },
            the_case_, drawing_, std::filesystem::path{});
        beats_ = std::jthread([this](const std::stop_token& stop) {
            while (!stop.stop_requested()) beat();
        });
    }

    simulation::ServedRoom& served() { return *served_; }
    simulation::SimulatedRig& rig() { return rig_; }

    /// Scan, match, light. False when it is refused.
    bool begin() {
        return press_when([](const OperatorModel& m) { return m.scan.enabled; }, OperatorAction::scan, 60s) &&
               press_when([](const OperatorModel& m) { return m.do_register.enabled; }, OperatorAction::do_register,
                          60s) &&
               press_when([](const OperatorModel& m) { return m.track.enabled || m.confirm; }, OperatorAction::confirm,
                          60s) &&
               press_when([](const OperatorModel& m) { return m.track.enabled; }, OperatorAction::track, 60s);
    }
    void press(OperatorAction action) { session_->post(action); }

    /// What the operator reads now.
    std::string words() const {
        const ProjectorProblem problem = projector_->problem();
        if (!problem.empty()) return "No projector: " + problem.what;
        return words_of(session_->model().status);
    }

private:
    static simulation::RoomSettings room_settings(double threshold) {
        simulation::RoomSettings room;
        room.preset = simulation::Preset::paper;
        room.seed = 1;
        room.skin_threshold_hu = threshold;
        room.light.whole_exposure = true;
        return room;
    }
    /// A monitor that is off shows nothing.
    RgbImage look() {
        try {
            return monitor_.look();
        } catch (const DeviceError&) {
            return {monitor_.width(), monitor_.height()};
        }
    }
    /// What the operator window does besides drawing.
    void beat() {
        projector_->window_lives();
        projector_->session_lives(session_->alive_at());
        const bool lost = !projector_->problem().empty();
        if (lost && !projector_lost_) session_->post(OperatorAction::dark);
        projector_lost_ = lost;
        std::this_thread::sleep_for(10ms);
    }
    bool press_when(const std::function<bool(const OperatorModel&)>& may, OperatorAction action, Instant patience) {
        const Instant until = clock_.now() + patience;
        while (clock_.now() < until) {
            const OperatorModel model = session_->model();
            if (may(model)) {
                session_->post(action);
                return true;
            }
            if (model.status.kind == StatusKind::refused) break;
            std::this_thread::sleep_for(20ms);
        }
        fmt::print("     {}\n", words());
        return false;
    }

    const Case& the_case_;
    CaseDrawing drawing_;
    MonitorPicture monitor_;
    simulation::SimulatedRig rig_;
    std::unique_ptr<simulation::ServedRoom> served_;
    RoomFile room_;
    RigCalibration calibration_;
    SteadyClock clock_;
    std::unique_ptr<ProjectorKeeper> projector_;
    std::unique_ptr<LiveSession> session_;
    bool projector_lost_ = false;
    std::jthread beats_;
};

struct Fault {
    std::string name;
    std::function<void()> begin, end;
    std::vector<std::string> words;  ///< all of these name it
    bool dark = true;                ///< the light must go; false: it is right until the fault is named
};

void xrandr(const std::string& words) {
    if (std::system(("xrandr --output DUMMY1 " + words).c_str()) != 0) fmt::print("     xrandr {}: failed\n", words);
}

std::vector<Fault> faults_of(simulation::ServedRoom& room) {
    const auto back = [] { xrandr("--mode 800x600 --right-of DUMMY0"); };
    const auto jump = [&room](Instant by) { room.right().set_clock_offset(room.right().clock_offset() + by); };
    return {
        {"camera hangs", [&] { room.right().silence(true); }, [&] { room.right().silence(false); }, {"Right camera"}},
        {"camera without power",
         [&] { room.right().power(false); },
         [&] { room.right().power(true); },
         {"Right camera"}},
        {"1 % of packets lost",
         [&] { room.left().lose_packets(0.01); },
         [&] { room.left().lose_packets(0); },
         {"Left camera", "packets"}},
        {"20 % of packets lost",
         [&] { room.left().lose_packets(0.2); },
         [&] { room.left().lose_packets(0); },
         {"Left camera", "packets"}},
        {"left and right exchanged",
         [&] { room.exchange_cameras(true); },
         [&] { room.exchange_cameras(false); },
         {"exchanged"}},
        {"a camera a frame late",
         [&] { room.hold_right_back(1); },
         [&] { room.hold_right_back(0); },
         {"Right camera", "late"}},
        {"a clock jumps ahead by 1 s", [=] { jump(1s); }, [] {}, {"Right camera", "clock"}},
        {"a clock jumps back by 1 s", [=] { jump(-1s); }, [] {}, {"Right camera", "clock"}},
        {"a clock jumps back by 30 ms", [=] { jump(-30ms); }, [] {}, {"Right camera", "clock"}},
        {"a clock drifts by 1 %",
         [&] { room.right().set_clock_drift(0.01); },
         [&] { room.right().set_clock_drift(-50e-6); },
         {"Right camera", "clock"},
         false},
        {"exposure changed by others",
         [&] { room.left().change_exposure(3ms); },
         [&] { room.left().change_exposure(10ms); },
         {"Left camera", "exposure"}},
        {"monitor off, on again", [] { xrandr("--off"); }, back, {"rojector"}},
        {"monitor resized", [] { xrandr("--mode 640x480"); }, back, {"rojector"}},
        {"monitors rearranged", [] { xrandr("--left-of DUMMY0"); }, back, {"rojector"}},
    };
}

/// Of one fault, over all rounds.
struct Outcome {
    std::vector<double> dark_ms, named_ms, back_s;
    int never_dark = 0, never_named = 0, never_back = 0, lit_again = 0;
    std::string said;
};

class Watch {
public:
    explicit Watch(Operation& operation) : operation_(operation) {}

    /// Light on most looks of half a second; pressed for where the session stopped.
    bool wait_for_light(Instant patience) {
        const Instant until = clock_.now() + patience;
        int lit = 0;
        Instant pressed{};
        while (clock_.now() < until) {
            lit = screen_.lit() ? lit + 1 : std::max(0, lit - 4);
            if (lit >= 40) return true;
            if (lit == 0 && clock_.now() - pressed > 3s) {
                if (pressed > Instant{}) fmt::print("     still dark: {}\n", operation_.words());
                operation_.press(OperatorAction::track);
                pressed = clock_.now();
            }
            std::this_thread::sleep_for(10ms);
        }
        return false;
    }

    /// How much of so long a while it is dark without any fault.
    double dark_share(Instant of) {
        const Instant until = clock_.now() + of;
        double looks = 0, dark = 0;
        for (; clock_.now() < until; std::this_thread::sleep_for(5ms), ++looks) dark += !screen_.lit();
        return dark / looks;
    }

    void watch(const Fault& fault, Outcome& outcome) {
        const auto named = [&] {
            const std::string now = operation_.words();
            const bool all = std::all_of(fault.words.begin(), fault.words.end(),
                                         [&](const std::string& word) { return now.find(word) != std::string::npos; });
            if (all) outcome.said = now;
            return all;
        };
        const Instant began = clock_.now();
        std::jthread beginning(fault.begin);  // xrandr takes a while, and is watched meanwhile
        std::optional<Instant> dark_at, named_at, dark_since;
        bool lit = true;
        while (clock_.now() - began < kLasts || (!named_at && clock_.now() - began < 4 * kLasts)) {
            const bool was_lit = std::exchange(lit, screen_.lit());
            const Instant after = clock_.now() - began;
            if (lit)
                dark_since.reset();
            else if (!dark_since)
                dark_since = after;
            if (dark_since && !dark_at && after - *dark_since >= kDark) dark_at = dark_since;
            if (lit && !was_lit && dark_at) ++outcome.lit_again;
            if (!named_at && named()) named_at = after;
            std::this_thread::sleep_for(1ms);
        }
        beginning.join();
        if (dark_at)
            outcome.dark_ms.push_back(1e3 * seconds(*dark_at));
        else
            ++outcome.never_dark;
        if (named_at)
            outcome.named_ms.push_back(1e3 * seconds(*named_at));
        else
            ++outcome.never_named, fmt::print("     {}: it says \"{}\"\n", fault.name, operation_.words());
        fault.end();
        const Instant ended = clock_.now();
        if (wait_for_light(40s))
            outcome.back_s.push_back(seconds(clock_.now() - ended));
        else
            ++outcome.never_back, fmt::print("     {}: it says \"{}\"\n", fault.name, operation_.words());
    }

private:
    Operation& operation_;
    SteadyClock clock_;
    test::ScreenLight screen_;
};

std::string median_and_worst(std::vector<double> of) {
    if (of.empty()) return "-";
    return fmt::format("{:.0f} / {:.0f}", median(of), *std::max_element(of.begin(), of.end()));
}

void print_table(const std::vector<Fault>& faults, const std::vector<Outcome>& outcomes) {
    fmt::print("\n{:28}{:>16}{:>16}{:>12}{:>11}\n", "", "dark, ms", "named, ms", "back, s", "lit again");
    for (std::size_t i = 0; i < faults.size(); ++i) {
        const Outcome& o = outcomes[i];
        if (o.dark_ms.empty() && o.never_dark == 0) continue;
        fmt::print("{:28}{:>16}{:>16}{:>12}{:>11}\n", faults[i].name, median_and_worst(o.dark_ms),
                   median_and_worst(o.named_ms), median_and_worst(o.back_s), o.lit_again);
        if (o.never_dark + o.never_named + o.never_back > 0)
            fmt::print("{:28}never dark {}, never named {}, not back {}\n", "", o.never_dark, o.never_named,
                       o.never_back);
        fmt::print("{:4}{}\n", "", o.said);
    }
}

int run(const std::string& program, int rounds, const std::string& only) {
    const Volume volume = read_volume(*test::example_patient());
    const Preparation prepared = prepare_case(
        volume, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {}, {}, "2001-10-14");
    std::unique_ptr<Operation> operation;
    try {
        operation = std::make_unique<Operation>(volume, prepared, program);
    } catch (const DeviceError& error) {
        fmt::print("skipped: {}. {}\n", error.what(), error.remedy);
        return 77;
    }
    Watch watch(*operation);
    expect(operation->begin(), "scan, match and light through the wire");
    const bool lit = watch.wait_for_light(20s);
    expect(lit, "there is light on the monitor" + (lit ? "" : ": " + operation->words()));
    if (test::failures() > 0) return 1;
    fmt::print("without a fault dark for {:.1f} % of ten seconds\n", 100 * watch.dark_share(10s));
    const std::vector<Fault> faults = faults_of(operation->served());
    std::vector<Outcome> outcomes(faults.size());
    std::minstd_rand random(1);
    for (int round = 0; round < rounds; ++round)
        for (std::size_t i = 0; i < faults.size(); ++i) {
            if (faults[i].name.find(only) == std::string::npos) continue;
            std::this_thread::sleep_for(std::chrono::milliseconds(std::uniform_int_distribution(0, 400)(random)));
            watch.watch(faults[i], outcomes[i]);
        }
    print_table(faults, outcomes);
    fmt::print("{} pictures a camera made, {} late; {} rounds\n\n", operation->served().made(),
               operation->served().late(), rounds);
    for (std::size_t i = 0; i < faults.size(); ++i) {
        const Outcome& o = outcomes[i];
        if (o.dark_ms.empty() && o.never_dark == 0) continue;
        expect(!faults[i].dark || (o.never_dark == 0 &&
                                   *std::max_element(o.dark_ms.begin(), o.dark_ms.end()) <= 1e3 * seconds(kLongest)),
               faults[i].name + (faults[i].dark ? ": dark within 300 ms" : ": light that is right may stay"));
        expect(o.never_named == 0, faults[i].name + ": named each time");
        expect(o.never_back == 0, faults[i].name + ": the light comes back when it is over");
    }
    if (test::failures() > 0 && test::too_busy_to_serve(operation->served())) return test::kSkipped;
    return test::failures() > 0;
}

}  // namespace

int main() {
    const char *rounds = std::getenv("ROUNDS"), *only = std::getenv("ONLY");
    return planlight::test::main_in_served_room(
        [&](const std::string& program) { return run(program, rounds ? std::atoi(rounds) : 1, only ? only : ""); });
}
