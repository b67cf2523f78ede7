#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/language_option.h"
#include "app/console.h"
#include "app/end_signals.h"
#include "app/json_text.h"
#include "app/live/camera_screen.h"
#include "app/live/test_light.h"
#include "app/windows/camera_page.h"
#include "planning_io/files/image_file.h"
#include "planning_io/types/error.h"
#include "registration/tracking/track_patient.h"

namespace planlight {
namespace {

struct CamerasOptions {
    Path room;
    std::string show = "dark", operator_monitor, language, theme;
    double seconds = 3;
    Path screenshot;
    bool headless = false, json = false;
};

nlohmann::ordered_json json_of(const WatchedCamera& camera) {
    nlohmann::ordered_json json{{"width", camera.width},
                                {"height", camera.height},
                                {"frames_hz", camera.frames_hz},
                                {"received", camera.received},
                                {"lost", camera.lost},
                                {"repeated", camera.repeated},
                                {"exposure_ms", camera.exposure_ms},
                                {"sharpness", camera.sharpness},
                                {"best_sharpness", camera.best_sharpness},
                                {"too_bright_percent", 100 * camera.clipped.too_bright},
                                {"too_dark_percent", 100 * camera.clipped.too_dark},
                                {"markers", nlohmann::ordered_json::array()},
                                {"notes", camera.notes},
                                {"fault", camera.fault ? nlohmann::ordered_json(camera.fault->problem) : nullptr}};
    for (const MarkerObservation& marker : camera.markers)
        json["markers"].push_back({{"x", marker.pixel.x()}, {"y", marker.pixel.y()}, {"radius_px", marker.radius_px}});
    return json;
}

void print_json(const WatchedRoom& watched, TestPicture shown) {
    nlohmann::ordered_json json{
        {"left", json_of(watched.left)},    {"right", json_of(watched.right)}, {"apart_ms", nullptr},
        {"allowed_ms", watched.allowed_ms}, {"together", watched.together()},  {"shown", text_of(shown)}};
    if (watched.apart_ms) json["apart_ms"] = *watched.apart_ms;
    std::cout << json_text(json) << std::endl;
}

void print_camera(const WatchedCamera& camera) {
    fmt::print(
        "{}: {} x {} pixels, {:.1f} frames a second, {} of {} lost, exposure {:.2f} ms\n  sharpness {:.2f} (best "
        "{:.2f}), too bright {:.1f} %, too dark {:.1f} %, {}\n",
        camera.name, camera.width, camera.height, camera.frames_hz, camera.lost, camera.received + camera.lost,
        camera.exposure_ms, camera.sharpness, camera.best_sharpness, 100 * camera.clipped.too_bright,
        100 * camera.clipped.too_dark,
        camera.markers.size() == 1 ? "1 marker" : fmt::format("{} markers", camera.markers.size()));
    for (const std::string& note : camera.notes) fmt::print("  {}.\n", note);
    if (camera.fault) fmt::print("  {}. {}\n", camera.fault->problem, camera.fault->remedy);
}

void print(const WatchedRoom& watched) {
    print_camera(watched.left);
    print_camera(watched.right);
    if (watched.apart_ms)
        fmt::print("The cameras {}: {:.2f} ms apart ({:.2f} allowed).\n",
                   watched.together() ? "expose together" : "do not expose together", *watched.apart_ms,
                   watched.allowed_ms);
    std::fflush(stdout);
}

/// Of a camera that sent nothing there are no figures; of one that failed later there are, and its fault.
void check_seen(const WatchedCamera& camera) {
    if (camera.picture) return;
    if (camera.fault) throw DeviceError(camera.name, camera.fault->problem, camera.fault->remedy);
    throw DeviceError(camera.name, "no frame came", "Look at its cable and its power, and whether its trigger runs.");
}

int say_once(const CamerasOptions& options, CameraWatch& watch, TestLight* light, const Clock& clock) {
    const Instant until = clock.now() + from_seconds(options.seconds);
    while (clock.now() < until && !asked_to_end()) {
        watch.look();
        if (light) light->keep();
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    const WatchedRoom watched = watch.state();
    const TestPicture shown = light ? light->shown() : TestPicture::dark;
    if (light && !light->trouble().empty())
        throw Error(ExitCode::device, light->trouble().what, light->trouble().remedy);
    check_seen(watched.left);
    check_seen(watched.right);
    if (options.json)
        print_json(watched, shown);
    else
        print(watched);
    return 0;
}

/// The light of the page; without one its buttons say why.
struct PageLight {
    std::unique_ptr<TestLight> light;
    ProjectorProblem problem;

    PageLight(const RoomFile& room, const RoomCameras& cameras, const Clock& clock) {
        try {
            light = std::make_unique<TestLight>(room, cameras, clock);
        } catch (const DeviceError& error) {
            problem = {error.what(), error.remedy};
        }
    }
    void put_into(CameraPageModel& model) const {
        const ProjectorProblem& trouble = light ? light->trouble() : problem;
        if (!light) model.no_light = "no projector";
        if (light) model.shown = light->shown();
        model.light_trouble = trouble.what;
        model.light_trouble_remedy = trouble.remedy;
    }
    void show(TestPicture picture) const {
        if (light) light->show(picture);
    }
};

int show_page(const CamerasOptions& options, const RoomFile& room, RoomCameras& cameras, CameraWatch& watch,
              const Clock& clock) {
    constexpr double kLongestRest_s = 0.05;
    CameraPage page(settings_of_page("Planlight cameras", options.language, options.theme, options.operator_monitor));
    std::jthread looking([&](const std::stop_token& stop) { watch.run(stop); });
    const PageLight light(room, cameras, clock);  // on every way out the first to go
    light.show(*test_picture_of(options.show));
    const Instant began = clock.now();
    while (!asked_to_end()) {
        CameraPageModel model = camera_page_model_of(watch.state(), room);
        light.put_into(model);
        const CameraPageAction action = page.frame(model);
        if (action == CameraPageAction::quit) return 0;
        if (action == CameraPageAction::dark) light.show(TestPicture::dark);
        if (const auto wanted = wanted_picture(action)) light.show(*wanted);
        if (action == CameraPageAction::forget_best) watch.forget_best();
        if (light.light) light.light->keep();
        if (!options.screenshot.empty() && seconds(clock.now() - began) > options.seconds) {
            write_png(page.screenshot(), options.screenshot, ReadableBy::owner);
            return 0;
        }
        page.rest(kLongestRest_s);
    }
    return 0;
}

int run_cameras(const CamerasOptions& options) {
    note_end_signals();
    const RoomFile room = read_room(options.room);
    const SteadyClock clock;
    RoomCameras cameras(room, clock);
    CameraWatch watch(cameras.pair().left(), cameras.pair().right(), clock, pair_settings(room),
                      tracking_settings_for({room.disc_mm, room.sticker_mm}).markers);
    print_to_user("Nobody may lie under the projector.\n");
    if (!options.headless && !options.json) return show_page(options, room, cameras, watch, clock);
    std::unique_ptr<TestLight> light;
    if (options.show != "dark") {
        light = std::make_unique<TestLight>(room, cameras, clock);
        light->show(*test_picture_of(options.show));
    }
    return say_once(options, watch, light.get(), clock);
}

}  // namespace

Run add_cameras(CLI::App& app) {
    const auto options = std::make_shared<CamerasOptions>();
    CamerasOptions& o = *options;
    auto* sub = add_command(app, "cameras",
                            "Aim, focus and expose the cameras of a room: what they see, how sharp, how bright, how "
                            "often; and test pictures of the projector",
                            "cameras --room room.json");
    sub->add_option("--room", o.room, "room.json (see `devices`)")->required();
    sub->add_option("--show", o.show,
                    "What the projector shows: dark, frame (its edges and its middle), star (to focus by), steps (of "
                    "grey), or name; in the window at the beginning")
        ->check(CLI::IsMember({"dark", "frame", "star", "steps", "name"}))
        ->capture_default_str();
    sub->add_flag("--headless", o.headless, "Without a window: look for a while and print the figures once");
    sub->add_option("--seconds", o.seconds, "So long without a window, and before --screenshot")
        ->check(CLI::Range(0.1, 3600.0))
        ->capture_default_str();
    sub->add_option("--operator", o.operator_monitor, "Monitor of the window (default: the primary one)");
    language_option(sub, o.language);
    theme_option(sub, o.theme);
    sub->add_option("--screenshot", o.screenshot, "Write a picture of the window after --seconds, and end")
        ->check(png_file());
    sub->add_flag("--json", o.json, "Without a window: print the figures once as JSON on standard output");
    return [options] { return run_cameras(*options); };
}

}  // namespace planlight
