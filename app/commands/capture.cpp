#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/capture_conversion.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/console.h"
#include "app/doctor/exposure.h"
#include "app/json_text.h"
#include "app/live/room_cameras.h"
#include "planning_io/case/capture_folder.h"
#include "planning_io/case/room_file.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/types/error.h"
#include "registration/scan/scan_surface.h"

namespace planlight {
namespace {

struct CaptureOptions {
    Path room, out;
    std::string set = "full";
    bool json = false;
};

StripeSettings stripes_of(const std::string& set, int width, int height) {
    if (set == "fast") return fast_stripes(width, height);
    if (set == "multi-frequency") return multi_frequency_stripes(width, height, true);
    StripeSettings stripes;
    stripes.width = width;
    stripes.height = height;
    return stripes;
}

void warn_of(const std::string& camera, const Exposure& exposure) {
    if (exposure.lit_share < 0.02)
        warn(fmt::format(
            "The {} camera sees almost nothing of the projector's light ({:.1f} % of its picture). Look where "
            "the projector shines, and lengthen the exposure.",
            camera, 100 * exposure.lit_share));
    else if (exposure.saturated_share > 0.05)
        warn(
            fmt::format("{:.0f} % of what the {} camera sees lit is saturated. Shorten its exposure or close its iris.",
                        100 * exposure.saturated_share, camera));
    else if (exposure.brightest_lit_grey < 60)
        warn(fmt::format(
            "White light is no brighter than grey {:.0f} of 255 to the {} camera. Lengthen its exposure, by "
            "whole cycles of the projector.",
            exposure.brightest_lit_grey, camera));
}

/// Where nothing is lit, nothing is known of what is.
nlohmann::json json_of(const Exposure& exposure) {
    const auto of_lit = [&](double value) { return exposure.lit_share > 0 ? nlohmann::json(value) : nlohmann::json(); };
    return {{"saturated_share", of_lit(exposure.saturated_share)},
            {"lit_share", exposure.lit_share},
            {"brightest_lit_grey", of_lit(exposure.brightest_lit_grey)}};
}

int run_capture(const CaptureOptions& options) {
    const RoomFile room = read_room(options.room);
    const SteadyClock clock;
    RoomCameras cameras(room, clock);
    for (const std::string& note : cameras.notes()) warn(note + ".");
    CommandProjector projector(room, &cameras);
    const StripeSettings stripes =
        stripes_of(options.set, projector.projector().width(), projector.projector().height());
    ProgressBar bar;
    const ScanCapture capture =
        capture_scan(projector.projector(), cameras.pair(), clock, stripes,
                     [&](int done, int of) { bar.show("capture", static_cast<double>(done) / of); });
    CaptureFolder folder = capture_folder_from(capture);
    folder.serials = {cameras.left().serial(), cameras.right().serial(), ""};
    if (options.out.has_parent_path()) make_folder(options.out.parent_path());
    write_capture(folder, options.out);
    // White and black come first.
    const Exposure left = exposure_of(capture.left[0], capture.left[1]),
                   right = exposure_of(capture.right[0], capture.right[1]);
    warn_of("left", left);
    warn_of("right", right);
    const PairCounts& pairs = cameras.pair().counts();
    const double took_s = seconds(capture.ended - capture.began);
    if (options.json)
        std::cout << json_text(nlohmann::json{{"folder", options.out.string()},
                                              {"pictures", capture.left.size()},
                                              {"took_s", took_s},
                                              {"apart_ms", 1e3 * seconds(pairs.apart)},
                                              {"left", json_of(left)},
                                              {"right", json_of(right)}})
                  << '\n';
    else
        fmt::print("{}: {} pictures a camera in {:.1f} s; the cameras' exposures were {:.2f} ms apart.\n",
                   options.out.string(), capture.left.size(), took_s, 1e3 * seconds(pairs.apart));
    return 0;
}

}  // namespace

Run add_capture(CLI::App& app) {
    const auto options = std::make_shared<CaptureOptions>();
    CaptureOptions& o = *options;
    auto* sub =
        add_command(app, "capture",
                    "Show the stripes in a room of real devices and keep what its cameras see: a board's pose, or "
                    "anything to scan",
                    "capture --room room.json --out captures/pose-01");
    sub->add_option("--room", o.room, "room.json (see `devices`)")->required();
    sub->add_option("--set", o.set, "Patterns: full, fast or multi-frequency")
        ->check(CLI::IsMember({"full", "fast", "multi-frequency"}))
        ->capture_default_str();
    sub->add_option("--out", o.out, "Capture folder to write; it must not be there yet")->required();
    json_flag(sub, o.json);
    return [options] { return run_capture(*options); };
}

}  // namespace planlight
