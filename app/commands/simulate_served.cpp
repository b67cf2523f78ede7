#include <fmt/format.h>

#include <csignal>
#include <thread>

#include "app/commands/simulate_options.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/case/room_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "projection/monitor_picture.h"
#include "registration/simulation/serve/served_room.h"

namespace planlight {
namespace {

volatile std::sig_atomic_t asked_to_end = 0;

/// rig.json and room.json for whoever operates in this room.
void write_files(const SimulateOptions& options, const simulation::SimulatedRig& rig,
                 const simulation::ServeSettings& served) {
    std::filesystem::create_directories(options.out);
    RigCalibration calibration = rig.calibration();
    calibration.serials.left_camera = served.left.serial;
    calibration.serials.right_camera = served.right.serial;
    write_rig(calibration, options.out / "rig.json");
    write_safely(options.out / "truth.json", rig.truth_json());
    RoomFile room;
    room.name = "Simulated room, served";
    room.rig = "rig.json";
    room.monitor = options.serve;
    room.left.device = served.left.serial;
    room.right.device = served.right.serial;
    room.left.transfer_ms = room.right.transfer_ms = 1e3 * seconds(served.latency);
    room.together = true;
    write_room(room, options.out / "room.json");
}

}  // namespace

int run_simulate_served(const SimulateOptions& options, simulation::SimulatedRig& rig) {
    if (options.addresses.size() != 2)
        throw InputError({}, "--addresses needs one address for each camera", "Give --addresses 127.0.0.1,127.0.0.2.");
    MonitorPicture monitor(options.serve);
    if (monitor.width() != rig.projector().width() || monitor.height() != rig.projector().height())
        throw DeviceError("Monitor " + options.serve,
                          fmt::format("has {} x {} pixels, and the room's projector {} x {}", monitor.width(),
                                      monitor.height(), rig.projector().width(), rig.projector().height()),
                          "Set that resolution (`xrandr`), or choose the other --preset.");
    simulation::ServeSettings settings;
    settings.left.serial = "SIM-L";
    settings.right.serial = "SIM-R";
    settings.left.address = options.addresses[0];
    settings.right.address = options.addresses[1];
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { asked_to_end = 1; });
    if (options.speed_mm_s > 0) rig.set_motion({options.speed_mm_s, rig.clock().now()});
    simulation::ServedRoom room(
        rig, [&] { return monitor.look(); }, settings);
    room.left().lose_packets(options.lose_packets);
    room.hold_right_back(options.right_behind);
    write_files(options, rig, settings);
    fmt::print(
        "{}: room.json, rig.json, truth.json. Two cameras answer on {} and {}; the projector is {}. Ctrl-C ends it.\n",
        options.out.string(), options.addresses[0], options.addresses[1], options.serve);
    std::fflush(stdout);
    while (!asked_to_end) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    fmt::print("{} pictures a camera were sent; {} times it could not keep up.\n", room.made(), room.late());
    return 0;
}

}  // namespace planlight
