#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/commands/capture_conversion.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/device_check.h"
#include "app/commands/rig_words.h"
#include "app/console.h"
#include "app/json_text.h"
#include "app/live/real_room.h"
#include "app/live/room_cameras.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/case/room_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "registration/calibration/check_drift.h"

namespace planlight {
namespace {

struct CheckOptions {
    Path capture, rig, log;  ///< log empty: beside the rig file
    Path room;               ///< of a live check: the capture is taken here; empty: `capture` is read
    bool live = false, json = false;
};

using Json = nlohmann::ordered_json;

/// The checks so far; those of another rig file are no part of the trend.
Json read_log(const Path& file) {
    if (!std::filesystem::exists(file))
        return {{"format", "planlight checks"}, {"version", 1}, {"checks", Json::array()}};
    try {
        Json log = Json::parse(read_whole(file));
        if (log.at("format") == "planlight checks" && log.at("version") == 1 && log.at("checks").is_array()) return log;
    } catch (const Json::exception&) {
    }
    throw DamagedFileError(file, "is not a log of checks", "Move it away; a new one is begun.");
}

/// Null is what was not known.
double known(const Json& number) {
    return number.is_null() ? 0 : number.get<double>();
}

/// Logs of earlier programs have the same figure under the name of a rms, which it is not.
double epipolar_of(const Json& entry) {
    return known(entry.at(entry.contains("epipolar_px") ? "epipolar_px" : "epipolar_rms_px"));
}

/// What goes into the trend: a device that was knocked, or another room's rig file, is no drift.
std::vector<EarlierCheck> earlier_checks(const Json& log, const std::string& rig_made_on, const Path& file) {
    std::vector<EarlierCheck> checks;
    try {
        for (const auto& entry : log.at("checks"))
            if (entry.at("rig_made_on") == rig_made_on && entry.at("verdict") == text_of(DriftCheck::Verdict::good))
                checks.push_back({entry.at("at_unix_s").get<double>() / 86400, epipolar_of(entry),
                                  known(entry.at("projector_rms_px"))});
    } catch (const Json::exception&) {
        throw DamagedFileError(file, "holds a check that is not whole", "Move it away; a new one is begun.");
    }
    return checks;
}

std::string said_of_projector(const DriftCheck& check) {
    if (check.projector_rms_px == 0) return "projector not placed";
    return fmt::format("projector {:.2f} px ({:.2f} mm of light), moved {:.2f} mm", check.projector_rms_px,
                       check.light_off_mm, check.moved_mm);
}

ScanCapture recorded_capture(const CheckOptions& options, const RigCalibration& rig) {
    ScanCapture capture = scan_capture_from(read_capture_of(rig, options.capture), options.capture);
    check_sizes(capture, rig, options.capture);
    return capture;
}

/// Taken now, by the room's own devices, which must be those of the rig file.
ScanCapture live_capture(const RoomFile& room, const RigCalibration& rig) {
    const SteadyClock clock;
    RoomCameras cameras(room, clock);
    CommandProjector projector(room, &cameras);
    check_devices(cameras, projector.projector(), rig);
    for (const std::string& note : cameras.notes()) warn(note + ".");
    StripeSettings stripes;
    stripes.width = projector.projector().width();
    stripes.height = projector.projector().height();
    ProgressBar bar;
    return capture_scan(projector.projector(), cameras.pair(), clock, stripes,
                        [&](int done, int of) { bar.show("capture", static_cast<double>(done) / of); });
}

int run_check(CheckOptions options) {
    std::optional<RoomFile> room;
    if (options.live) room = read_room(options.room);
    if (options.rig.empty() && room) options.rig = room->rig;
    if (options.rig.empty())
        throw Error(ExitCode::usage, "no rig file was named",
                    "Give --rig rig.json, or --room room.json, which names one.");
    const RigCalibration rig = read_rig(options.rig);
    Path file = options.log;
    if (file.empty()) {
        file = options.rig;
        file.replace_extension();
        file += "-checks.json";
    }
    Json log = read_log(file);
    const ScanCapture capture = room ? live_capture(*room, rig) : recorded_capture(options, rig);
    const ScanResult scan = scan_from_capture(capture, rig);
    const DriftCheck check = check_drift(scan, rig);
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    const auto if_placed = [&](double value) { return check.projector_rms_px == 0 ? Json() : Json(value); };
    const Json entry = {{"at_unix_s", now},
                        {"rig_made_on", rig.made_on},
                        {"verdict", text_of(check.verdict)},
                        {"points", check.points},
                        {"epipolar_px", check.epipolar_px > 0 ? Json(check.epipolar_px) : Json()},
                        {"projector_rms_px", if_placed(check.projector_rms_px)},
                        {"projector_after_px", if_placed(check.projector_after_px)},
                        {"camera_k1_off", if_placed(check.bent.k1_off)},
                        {"camera_k1_sigma", if_placed(check.bent.k1_sigma)},
                        {"projector_bent_px", if_placed(check.bent.projector_px)},
                        {"light_off_mm", if_placed(check.light_off_mm)},
                        {"projector_moved_mm", if_placed(check.moved_mm)},
                        {"projector_turned_deg", if_placed(check.turned * 180 / std::numbers::pi)}};
    log["checks"].push_back(entry);
    const auto trends = drift_trends(earlier_checks(log, rig.made_on, file));
    write_safely(file, json_text(log) + "\n");
    Json result = entry;
    result["reason"] = check.reason;
    result["rig"] = rig_state_json(scan.rig);
    result["trends"] = Json::array();
    for (const DriftTrend& trend : trends) {
        result["trends"].push_back(
            {{"what", trend.what}, {"px_per_day", trend.px_per_day}, {"days_to_limit", trend.days_to_limit}});
        warn(fmt::format("the {} grows by {:.3f} px a day; its limit is reached in about {:.0f} days", trend.what,
                         trend.px_per_day, trend.days_to_limit));
    }
    if (options.json)
        std::cout << json_text(result) << '\n';
    else
        fmt::print("{}: {} points, epipolar error {}, {}; check {} in {}.\n", text_of(check.verdict), check.points,
                   check.epipolar_px > 0 ? fmt::format("{:.2f} px", check.epipolar_px) : "not known",
                   said_of_projector(check), log["checks"].size(), file.string());
    if (check.verdict != DriftCheck::Verdict::good) throw CheckFailedError(check.reason, check.remedy);
    return 0;
}

}  // namespace

Run add_check(CLI::App& app) {
    const auto options = std::make_shared<CheckOptions>();
    CheckOptions& o = *options;
    auto* sub = add_command(app, "check", "One scan of anything against rig.json: has the rig moved? (exit 6 if so)",
                            "check room/capture --rig room/rig.json\n"
                            "  planlight check --live --room room.json");
    auto* capture = sub->add_option("capture", o.capture, "Capture folder of a scan: a board, a phantom, the patient");
    sub->add_option("--rig", o.rig, "rig.json (default of --live: that of the room)");
    auto* live = sub->add_flag("--live", o.live, "Take the scan now, of whatever lies in the light of --room")
                     ->excludes(capture);
    auto* room = sub->add_option("--room", o.room, "room.json of the real devices (see `devices`)")->needs(live);
    live->needs(room);
    sub->parse_complete_callback([live, capture] {
        if (live->count() == 0 && capture->count() == 0)
            throw CLI::RequiredError("capture (a folder) with --rig rig.json, or --live with --room room.json,");
    });
    sub->add_option("--log", o.log, "Where the checks are kept for the trend (default: beside rig.json)");
    json_flag(sub, o.json);
    return [options] { return run_check(*options); };
}

}  // namespace planlight
