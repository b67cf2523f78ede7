#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/console.h"
#include "app/json_text.h"
#include "planning_io/case/room_file.h"
#include "planning_io/types/error.h"
#include "projection/monitor/projector_window.h"
#include "registration/devices/genicam_camera.h"

namespace planlight {
namespace {

struct DevicesOptions {
    Path out;
    bool json = false;
};

std::vector<Monitor> monitors_or_none() {
    try {
        return list_monitors();
    } catch (const DeviceError&) {
        return {};  // no display: the cameras are worth a list all the same
    }
}

/// The room that these devices may be: the first two cameras, and the first monitor that is not the operator's.
RoomFile first_room(const std::vector<FoundCamera>& cameras, const std::vector<Monitor>& monitors) {
    if (cameras.size() < 2)
        throw DeviceError(
            "Cameras", fmt::format("{} of the two that a room needs answer; no room file was written", cameras.size()),
            "Look at their cables and power; GigE cameras must be in this machine's network.");
    RoomFile room;
    room.name = "Room";
    room.rig = "rig.json";
    const auto name_of = [](const FoundCamera& camera) { return camera.serial.empty() ? camera.id : camera.serial; };
    room.left.device = name_of(cameras[0]);
    room.right.device = name_of(cameras[1]);
    room.left.exposure_ms = room.right.exposure_ms = 10;
    for (const Monitor& monitor : monitors)
        if (room.monitor.empty() || (!monitor.primary && monitors.size() > 1)) room.monitor = monitor.name;
    return room;
}

nlohmann::json json_of(const std::vector<FoundCamera>& cameras, const std::vector<Monitor>& monitors) {
    nlohmann::json json{{"cameras", nlohmann::json::array()}, {"monitors", nlohmann::json::array()}};
    for (const FoundCamera& c : cameras)
        json["cameras"].push_back({{"serial", c.serial},
                                   {"id", c.id},
                                   {"vendor", c.vendor},
                                   {"model", c.model},
                                   {"address", c.address},
                                   {"protocol", c.protocol}});
    for (const Monitor& m : monitors)
        json["monitors"].push_back({{"name", m.name},
                                    {"width", m.width},
                                    {"height", m.height},
                                    {"primary", m.primary},
                                    {"model", m.model},
                                    {"serial", m.serial}});
    return json;
}

int run_devices(const DevicesOptions& options) {
    const std::vector<FoundCamera> cameras = list_genicam_cameras();
    const std::vector<Monitor> monitors = monitors_or_none();
    if (options.json) {
        std::cout << json_text(json_of(cameras, monitors)) << '\n';
    } else {
        fmt::print("Cameras (GenICam):{}\n", cameras.empty() ? " none answers" : "");
        for (const FoundCamera& c : cameras)
            fmt::print("  serial {}  {} {}  at {}  ({})\n", c.serial, c.vendor, c.model, c.address, c.protocol);
        fmt::print("Monitors:{}\n", monitors.empty() ? " none (no display)" : "");
        for (const Monitor& m : monitors)
            fmt::print("  {}  {} x {}{}{}\n", m.name, m.width, m.height, m.primary ? "  primary" : "",
                       m.model.empty() ? "" : "  " + m.model);
    }
    if (options.out.empty()) return 0;
    write_room(first_room(cameras, monitors), options.out);
    print_to_user(fmt::format(
        "{}: the first two cameras and a monitor. Exchange \"left\" and \"right\" if they stand the other way, and "
        "calibrate the rig; set \"together\" when one triggers the other.\n",
        options.out.string()));
    return 0;
}

}  // namespace

Run add_devices(CLI::App& app) {
    const auto options = std::make_shared<DevicesOptions>();
    DevicesOptions& o = *options;
    auto* sub = add_command(app, "devices", "Cameras and monitors that answer, and a first room.json",
                            "devices --out room.json");
    sub->add_option("--out", o.out, "room.json to write, of the first two cameras and the projector's monitor");
    json_flag(sub, o.json);
    return [options] { return run_devices(*options); };
}

}  // namespace planlight
