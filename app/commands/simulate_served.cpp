#include <fmt/format.h>

#include <thread>

#include "app/commands/simulate_options.h"
#include "app/console.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/case/room_file.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "projection/monitor/monitor_picture.h"
#include "registration/simulation/serve/head_under_light.h"
#include "registration/simulation/serve/served_room.h"

namespace planlight {
namespace {

/// room.json for whoever operates in this room.
void write_room_file(const SimulateOptions& options, const simulation::ServeSettings& served) {
    RoomFile room;
    room.name = "Simulated room, served";
    room.rig = "rig.json";
    room.monitor = options.serve;
    room.left.device = served.left.serial;
    room.right.device = served.right.serial;
    room.left.transfer_ms = room.right.transfer_ms = 1e3 * seconds(served.latency);
    room.left.global_shutter = room.right.global_shutter = true;
    room.together = true;
    write_room(room, options.out / "room.json");
}

/// Its rig and its truth.
void write_rig_files(const SimulateOptions& options, const simulation::SimulatedRig& rig,
                     const simulation::ServeSettings& served) {
    RigCalibration calibration = rig.calibration();
    calibration.serials.left_camera = served.left.serial;
    calibration.serials.right_camera = served.right.serial;
    write_rig(calibration, options.out / "rig.json");
    write_safely(options.out / "truth.json", rig.truth_json());
}

void check_monitor(const MonitorPicture& monitor, const std::string& name, const Projector& projector) {
    if (monitor.width() == projector.width() && monitor.height() == projector.height()) return;
    throw DeviceError("Monitor " + name,
                      fmt::format("has {} x {} pixels, and the room's projector {} x {}", monitor.width(),
                                  monitor.height(), projector.width(), projector.height()),
                      "Set that resolution (`xrandr`), or choose the other --preset.");
}

simulation::ServeSettings serve_settings(const SimulateOptions& options) {
    if (options.addresses.size() != 2)
        throw InputError({}, "--addresses needs one address for each camera", "Give --addresses 127.0.0.1,127.0.0.2.");
    simulation::ServeSettings settings;
    settings.left.serial = "SIM-L";
    settings.right.serial = "SIM-R";
    settings.left.address = options.addresses[0];
    settings.right.address = options.addresses[1];
    return settings;
}

/// Serves until somebody ends it.
void serve(const SimulateOptions& options, const simulation::ServeSettings& settings, MonitorPicture& monitor,
           const simulation::ServedDevices& devices, const std::string& files,
           const std::function<void()>& write_files) {
    note_end_signals();
    simulation::ServedRoom room(
        devices, [&] { return monitor.look(); }, settings);
    room.left().lose_packets(options.lose_packets);
    room.hold_right_back(options.right_behind);
    make_folder(options.out);
    write_files();
    write_room_file(options, settings);
    fmt::print("{}: room.json, {}. Two cameras answer on {} and {}; the projector is {}. Ctrl-C ends it.\n",
               options.out.string(), files, options.addresses[0], options.addresses[1], options.serve);
    std::fflush(stdout);
    while (!asked_to_end()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    fmt::print("{} pictures a camera were sent; {} times it could not keep up.\n", room.made(), room.late());
}

}  // namespace

int run_simulate_served(const SimulateOptions& options, simulation::SimulatedRig& rig) {
    const simulation::ServeSettings settings = serve_settings(options);
    MonitorPicture monitor(options.serve);
    check_monitor(monitor, options.serve, rig.projector());
    simulation::HeadUnderLight head(rig, options.speed_mm_s);
    serve(options, settings, monitor, {head, rig.cameras(), rig.clock(), [&](Instant duration) { rig.wait(duration); }},
          "rig.json, truth.json", [&] { write_rig_files(options, rig, settings); });
    return 0;
}

int run_simulate_served_board(const SimulateOptions& options, simulation::SimulatedBoardRoom& room) {
    const simulation::ServeSettings settings = serve_settings(options);
    MonitorPicture monitor(options.serve);
    check_monitor(monitor, options.serve, room.projector());
    simulation::PersonSettings person;
    person.time_goes_on = true;
    room.let_person_carry(person);
    serve(options, settings, monitor,
          {room.projector(), room.cameras(), room.clock(), [&](Instant duration) { room.wait(duration); }},
          "truth.json (rig.json is what the calibration makes)",
          [&] { write_safely(options.out / "truth.json", room.truth_json() + "\n"); });
    fmt::print("The person laid the board down in {} places.\n", room.person()->stops_made());
    return 0;
}

}  // namespace planlight
