// A whole session through the wire: the simulated room served as two GigE Vision cameras and a projector whose light is
// what stands on the second monitor; scan, match and light by the same devices that real hardware has, against the same
// room without a wire. Run by two_monitors.sh: `session_in_served_room FOLDER`, with PLANLIGHT the program (for its
// projector process) and SEEDS how many rooms (default 1), GUIDED a folder of guided calibrations of these rooms
// (default: the room's own), MOVING=1 to follow a head that moves as well, by hand: two cores that serve a moving head
// are often too slow to be followed. Exit code 0 when every patient was found, the light at rest is within 0.1 mm
// (95 %) of that without a wire, the light on a moving head within 0.25 mm, and each fault was noticed by name and
// dark; 77: skipped.
#include <fmt/format.h>

#include <atomic>
#include <cstdlib>
#include <map>
#include <random>
#include <thread>

#include "app/evaluation/distribution.h"
#include "app/evaluation/measure_overlay.h"
#include "app/live/projector_keeper.h"
#include "app/live/real_room.h"
#include "app/prepare_case.h"
#include "app/session.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/statistics.h"
#include "planning_io/volume/read_volume.h"
#include "projection/monitor/monitor_picture.h"
#include "registration/simulation/serve/head_under_light.h"
#include "root_window.h"
#include "served_room_test.h"

namespace {

using namespace planlight;
using namespace std::chrono_literals;
using test::expect;

constexpr int kUpdates = 30, kMeasuredEvery = 5;
constexpr int kMovingUpdates = 75, kMovingMeasuredEvery = 5;
constexpr double kSpeed_mm_s = 20;  // as in the demo
// Poses through the wire are older when they are drawn with, by what the frames take: at 20 mm/s the prediction of a
// head that turns round is wrong by a few tenths.
constexpr double kMovingWorse_mm = 0.25;

struct Figures {
    bool found = false;
    std::string refused;
    double tre_mm = 0, light_p95_mm = 0, scan_s = 0, updates_per_s = 0;
    int lit = 0;
    std::vector<double> late_ms;  ///< from mid-exposure to the picture on the display
    int moving_lit = 0;
    std::map<std::string, int> moving_dark;  ///< reasons
    std::vector<double> moving_late_ms, moving_mm;
};

double p95(const std::vector<double>& values) {
    return values.empty() ? 0 : quantile(values, 0.95);
}

simulation::RoomSettings room_of(unsigned seed, double threshold) {
    simulation::RoomSettings room;
    room.preset = simulation::Preset::paper;
    room.seed = seed;
    room.skin_threshold_hu = threshold;
    room.light.whole_exposure = true;
    return room;
}

/// Of a guided calibration of that room ($GUIDED/guided-SEED.json, as calibrate_served_room.sh leaves it), laid into
/// the frame of `calibration` by the left camera; else `calibration` itself.
RigCalibration rig_to_operate_with(const RigCalibration& calibration, unsigned seed) {
    const char* folder = std::getenv("GUIDED");
    if (!folder) return calibration;
    RigCalibration guided = read_rig(fmt::format("{}/guided-{}.json", folder, seed));
    const RigidTransform guided_from_rig =
        guided.left_camera.device_from_rig.inverse() * calibration.left_camera.device_from_rig;
    for (CameraModel* device : {&guided.left_camera, &guided.right_camera, &guided.projector})
        device->device_from_rig = device->device_from_rig * guided_from_rig;
    fmt::print("     by the rig of {}\n", guided.made_on);
    return guided;
}

/// Scan, match and some updates at rest, in whatever room; `truth` is the room by itself.
Figures operate(const Case& the_case, Session& session, const Clock& clock, const simulation::SimulatedRig& truth) {
    Figures figures;
    const Instant began = clock.now();
    session.scan();
    figures.scan_s = seconds(clock.now() - began);
    const RegistrationResult& found = session.find_patient();
    if (found.verdict == Verdict::no) {
        figures.refused = found.reasons.front();
        return figures;
    }
    figures.found = true;
    if (found.verdict == Verdict::ask) session.confirm();
    const RigidTransform rig_from_ct = truth.true_rig_from_ct({});
    for (const auto& p : points_of(the_case.plan))
        figures.tre_mm = std::max(figures.tre_mm, (found.patient_from_ct * p - rig_from_ct * p).norm());
    OverlayErrors errors;
    const Instant from = clock.now();
    for (int i = 0; i < kUpdates; ++i) {
        const Session::Update update = session.update();
        if (!update.overlay.lit) {
            fmt::print("     dark: {}\n", update.overlay.reason);
            continue;
        }
        ++figures.lit;
        figures.late_ms.push_back(1e3 * seconds(update.overlay.lit_from - update.pose.at));
        if (i % kMeasuredEvery == 0)
            errors.append(measure_overlay(truth, the_case.plan, session.drawing(), session.renderer(),
                                          session.render_settings(), {update.overlay.rig_from_ct, {}, {}}, false));
    }
    figures.updates_per_s = kUpdates / seconds(clock.now() - from);
    figures.light_p95_mm = p95(errors.position_mm);
    return figures;
}

/// Updates of a head that moves: pictures that were drawn, each with a random moment of its light, of the room's clock,
/// which was 0 at `room_began` of the session's.
std::vector<DrawnPicture> follow(Session& session, Instant room_began, Figures& figures) {
    std::mt19937 random(1);
    std::vector<DrawnPicture> drawn;
    std::optional<DrawnPicture> waiting;
    for (int i = 0; i < kMovingUpdates; ++i) {
        const Session::Update update = session.update();
        if (waiting && update.overlay.lit) {
            const double share = std::uniform_real_distribution<double>(0, 1)(random);
            waiting->lit_at += from_seconds(share * seconds(update.overlay.lit_from - waiting->lit_at));
        }
        if (waiting) drawn.push_back({waiting->rig_from_ct, waiting->rig_from_patient, waiting->lit_at - room_began});
        waiting.reset();
        if (!update.overlay.lit) {
            ++figures.moving_dark[update.overlay.reason];
            continue;
        }
        ++figures.moving_lit;
        figures.moving_late_ms.push_back(1e3 * seconds(update.overlay.lit_from - update.pose.at));
        if (i % kMovingMeasuredEvery == 0)
            waiting = DrawnPicture{update.overlay.rig_from_ct, *update.pose.rig_from_patient, update.overlay.lit_from};
    }
    return drawn;
}

/// Where their light fell; the room must not be changed by anybody meanwhile.
void measure_moving(const std::vector<DrawnPicture>& drawn, const simulation::SimulatedRig& rig, const Case& the_case,
                    Session& session, Figures& figures) {
    OverlayErrors errors;
    for (const DrawnPicture& picture : drawn)
        errors.append(measure_overlay(rig, the_case.plan, session.drawing(), session.renderer(),
                                      session.render_settings(), picture, false));
    figures.moving_mm = errors.position_mm;
}

void print(const char* where, const Figures& f) {
    if (!f.found) {
        fmt::print("     {}: refused: {}\n", where, f.refused);
        return;
    }
    auto late = f.late_ms;
    fmt::print(
        "     {}: registration {:.2f} mm, light at rest {:.2f} mm (95 %), {} of {} updates lit, scan {:.1f} s, {:.1f} "
        "updates/s, mid-exposure to light {:.0f} / {:.0f} ms (median / 99 %)\n",
        where, f.tre_mm, f.light_p95_mm, f.lit, kUpdates, f.scan_s, f.updates_per_s, late.empty() ? 0 : median(late),
        late.empty() ? 0 : quantile(late, 0.99));
    if (f.moving_lit + f.moving_dark.size() == 0) return;
    auto moving_late = f.moving_late_ms;
    fmt::print(
        "     {}: head moving at up to {:g} mm/s: light {:.2f} mm (95 %, {} places), {} of {} updates lit, "
        "mid-exposure "
        "to light {:.0f} / {:.0f} ms (median / 99 %)\n",
        where, kSpeed_mm_s, p95(f.moving_mm), f.moving_mm.size(), f.moving_lit, kMovingUpdates,
        moving_late.empty() ? 0 : median(moving_late), moving_late.empty() ? 0 : quantile(moving_late, 0.99));
    for (const auto& [reason, times] : f.moving_dark) fmt::print("     {} times dark: {}\n", times, reason);
}

/// The session refuses with these words within `patience`, and how long it took.
bool refuses(Session& session, const std::string& words, Instant patience, const Clock& clock) {
    const Instant from = clock.now();
    while (clock.now() - from < patience) {
        try {
            session.update();
        } catch (const DeviceError& error) {
            session.go_dark();
            fmt::print("     after {:.0f} ms: {}\n", 1e3 * seconds(clock.now() - from), error.what());
            return std::string(error.what()).find(words) != std::string::npos;
        }
    }
    return false;
}

bool goes_on(Session& session, Instant patience, const Clock& clock) {
    const Instant from = clock.now();
    while (clock.now() - from < patience) {
        try {
            if (session.update().overlay.lit) return true;
        } catch (const DeviceError&) {
            std::this_thread::sleep_for(100ms);
        }
    }
    return false;
}

void faults(Session& session, simulation::ServedRoom& served, ProjectorKeeper& projector, MonitorPicture& monitor,
            const Clock& clock) {
    served.right().silence(true);
    expect(refuses(session, "Right camera", 5s, clock), "a camera that is pulled out is named");
    expect(monitor.look().pixels == RgbImage(monitor.width(), monitor.height()).pixels, "and the monitor is dark");
    served.right().silence(false);
    expect(goes_on(session, 20s, clock), "it comes back, and the session goes on with the same match");
    served.left().change_exposure(3ms);
    expect(refuses(session, "Left camera", 10s, clock), "an exposure that somebody changed is named");
    served.left().change_exposure(10ms);
    expect(goes_on(session, 20s, clock), "and set again by itself");
    expect(projector.problem().empty(), "the projector is well all the time");
}

int run(const std::string& program, unsigned seeds) {
    const bool moving_too = std::getenv("MOVING") != nullptr;
    const Volume volume = read_volume(*test::example_patient());
    const Preparation prepared = prepare_case(
        volume, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {}, {}, "2001-10-14");
    const CaseDrawing drawing(prepared.prepared);
    const Case& the_case = prepared.prepared;
    MonitorPicture monitor("DUMMY1");
    for (unsigned seed = 1; seed <= seeds; ++seed) {
        simulation::SimulatedRig truth(volume, points_of(the_case.plan), room_of(seed, prepared.threshold));
        Figures without;
        {
            simulation::SimulatedRig rig(volume, points_of(the_case.plan), room_of(seed, prepared.threshold));
            SessionSettings settings;
            settings.while_computing = [&] { rig.wait(10ms); };
            Session session(the_case, drawing, rig.calibration(), rig.projector(), rig.cameras(), rig.clock(),
                            settings);
            without = operate(the_case, session, rig.clock(), truth);
            if (moving_too) rig.set_motion({kSpeed_mm_s, rig.clock().now()});
            if (moving_too && without.found)
                measure_moving(follow(session, {}, without), rig, the_case, session, without);
        }
        simulation::SimulatedRig rig(volume, points_of(the_case.plan), room_of(seed, prepared.threshold));
        const simulation::ServeSettings serve = test::cameras_with_their_own_clocks();
        simulation::HeadUnderLight head(rig, 0);
        std::unique_ptr<simulation::ServedRoom> served;
        try {
            served = std::make_unique<simulation::ServedRoom>(
                simulation::ServedDevices{head, rig.cameras(), rig.clock(), [&](Instant how) { rig.wait(how); }},
                [&] { return monitor.look(); }, serve);
        } catch (const DeviceError& error) {
            fmt::print("skipped: {}. {}\n", error.what(), error.remedy);
            return 77;
        }
        RoomFile room;
        room.together = true;  // both expose at once, by the simulator
        room.left.device = "SIM-L";
        room.right.device = "SIM-R";
        room.left.exposure_ms = room.right.exposure_ms = 10;
        room.left.transfer_ms = room.right.transfer_ms = 1e3 * seconds(serve.latency);
        room.left.global_shutter = room.right.global_shutter = true;
        RigCalibration calibration = rig_to_operate_with(rig.calibration(), seed);
        calibration.serials = {"SIM-L", "SIM-R", ""};
        ProjectorKeeperSettings keeper;
        keeper.process.program = program;
        keeper.process.light_delay = 70ms;  // the lamp's 25, and what software OpenGL takes to paint
        ProjectorKeeper projector("DUMMY1", keeper);
        const SteadyClock clock;
        const std::jthread beats([&](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                projector.window_lives();
                projector.session_lives(clock.now());
                std::this_thread::sleep_for(20ms);
            }
        });
        RealRoom real(room, calibration, &projector);
        SessionSettings settings;
        settings.patience = 2000ms;
        Session session(the_case, drawing, real.rig(), real.projector(), real.cameras(), real.clock(), settings);
        Figures with;
        std::vector<DrawnPicture> moving;
        try {
            with = operate(the_case, session, real.clock(), truth);
            if (moving_too) head.set_speed(kSpeed_mm_s);
            if (moving_too && with.found) moving = follow(session, served->room_began(), with);
        } catch (const Error& error) {
            with.refused = std::string(error.what()) + " " + error.remedy;
        }
        const auto& pairs = static_cast<PairedCameras&>(real.cameras()).counts();
        fmt::print("seed {}: {} pictures a camera made, {} late; {} pairs, alone {} left and {} right\n", seed,
                   served->made(), served->late(), pairs.pairs, pairs.left_alone, pairs.right_alone);
        const bool too_busy = test::too_busy_to_serve(*served);
        if (with.found && seed == 1 && !too_busy && !moving_too)
            faults(session, *served, projector, monitor, real.clock());
        served.reset();  // nobody moves the head any more
        measure_moving(moving, rig, the_case, session, with);
        print("in process", without);
        print("by wire   ", with);
        if (too_busy) return test::kSkipped;
        expect(with.found, "found through the wire");
        expect(with.found && std::abs(with.light_p95_mm - without.light_p95_mm) <= 0.1,
               "the light at rest is as true as without a wire, within 0.1 mm");
        if (!moving_too) continue;
        expect(with.moving_lit > kMovingUpdates / 2, "a moving head is lit most of the time");
        expect(p95(with.moving_mm) - p95(without.moving_mm) <= kMovingWorse_mm,
               "the light on it is as true as without a wire, within 0.25 mm");
    }
    return test::failures() > 0;
}

}  // namespace

int main() {
    const char* seeds = std::getenv("SEEDS");
    return planlight::test::main_in_served_room(
        [&](const std::string& program) { return run(program, seeds ? static_cast<unsigned>(std::atoi(seeds)) : 1); });
}
