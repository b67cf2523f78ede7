#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/belonging.h"
#include "app/case_model.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/language_option.h"
#include "app/commands/review_recording.h"
#include "app/console.h"
#include "app/json_text.h"
#include "app/live/clickable_scan.h"
#include "app/live/live_window.h"
#include "app/report/clearance_json.h"
#include "app/site_settings.h"
#include "app/windows/scene_view.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/case/registration_file.h"
#include "planning_io/files/image_file.h"
#include "planning_io/plan/point_pairs_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"

namespace planlight {

namespace {

struct ReviewOptions {
    Path case_folder, picture, registration, cloud;
    Path landmarks;              ///< table to click landmarks into; empty: not wanted
    std::string view = "after";  ///< before, after, error
    bool json = false;
    RecordingReviewOptions recorded;  ///< where a recording is named in the case's place
};

void set_status(const RegistrationResult& found, OperatorModel& model) {
    if (found.verdict == Verdict::yes) {
        model.status = {StatusKind::ready, "The patient was found. Nothing is projected.", {}};
    } else if (found.verdict == Verdict::ask) {
        model.status = {StatusKind::check, "Not sure: look whether the scan fits the skin.", found.reasons};
    } else {
        model.status = {StatusKind::refused, "The patient was not found.", found.reasons};
    }
}

/// Null where none is named. `match`: of the cloud; empty where landmarks are clicked.
std::shared_ptr<const PointCloud> cloud_of(const ReviewOptions& options,
                                           const std::optional<RegistrationResult>& match) {
    if (options.cloud.empty()) return nullptr;
    if (options.registration.empty() && options.landmarks.empty())
        throw Error(ExitCode::usage, "nothing says where the cloud lies on the skin",
                    "Give its match with --registration, or click landmarks on both with --landmarks FILE.");
    return std::make_shared<PointCloud>(match ? read_cloud_of(*match, options.cloud, options.registration)
                                              : read_cloud(options.cloud, {1, true}));
}

/// The window until landmarks are used or it is closed; what was clicked is kept either way.
int run_landmarks(const ReviewOptions& options, const CaseDrawing& drawing, const PointCloud& cloud,
                  OperatorModel model) {
    const bool is_there = std::filesystem::exists(options.landmarks);
    const std::vector<PointPair> already = is_there ? read_point_pairs(options.landmarks) : std::vector<PointPair>{};
    const auto clickable = clickable_scan(cloud);
    if (!clickable)
        throw InputError(options.cloud, "has neither projector pixels nor normals, so that its points make no surface",
                         "Take the cloud of `planlight scan`, or give it normals.");
    model.landmarks = LandmarkViews{&drawing.skin, clickable};
    model.use_landmarks = "Save landmarks";
    if (!model.fit)
        model.status = {StatusKind::ready, "Click landmarks on the skin and on the scan.", {"Nothing is projected."}};
    const std::vector<PointPair> pairs = click_landmarks(
        model, already, settings_of_window(options.recorded.language, options.recorded.theme, read_site_settings()));
    if (pairs.empty()) {
        fmt::print("No landmarks were clicked; nothing was written.\n");
        return 0;
    }
    write_point_pairs(pairs, options.landmarks);
    fmt::print("{} landmarks in {}. Next: planlight register {} --cloud {} --pairs {} --out registration.json\n",
               pairs.size(), options.landmarks.string(), options.case_folder.string(), options.cloud.string(),
               options.landmarks.string());
    return 0;
}

int run_review(const ReviewOptions& options) {
    if (is_recording(options.case_folder)) {
        RecordingReviewOptions recorded = options.recorded;
        if (!options.registration.empty() || !options.cloud.empty() || (!options.picture.empty() && !recorded.show))
            throw Error(ExitCode::usage, "a recording is looked at by itself", "Leave out what is for a case.");
        recorded.recording = options.case_folder;
        recorded.json = options.json;
        recorded.picture = options.picture;
        return recorded.show ? show_recording(recorded) : run_recording_review(recorded);
    }
    if (!options.recorded.out.empty() || options.recorded.at_s >= 0 || !options.recorded.clip_s.empty() ||
        options.recorded.show)
        throw Error(ExitCode::usage, "--out, --at, --clip and --show are for a recording (.plrec)",
                    "Name a recording in the case's place.");
    const Case the_case = read_case(options.case_folder);
    const CaseDrawing drawing(the_case, drawing_settings(read_site_settings()));
    OperatorModel model = model_of_case(the_case, drawing);
    std::optional<RegistrationResult> found;
    std::vector<std::string> unknown;
    if (!options.registration.empty()) {
        found = read_registration(options.registration);
        check_case(*found, the_case, options.registration, unknown);
    }
    const std::shared_ptr<const PointCloud> cloud = cloud_of(options, found);
    for (const std::string& what : unknown) warn(what);
    if (found) {
        show_match(the_case, *found, cloud, model);
        set_status(*found, model);
    }
    const FitView view = options.view == "before"  ? FitView::before
                         : options.view == "error" ? FitView::predicted_error
                                                   : FitView::after;
    nlohmann::json items = nlohmann::json::array();
    for (const auto& item : drawing.drawing.items)
        items.push_back({{"name", item.name},
                         {"label", item.label},
                         {"distance_to_skin_mm", item.distance_to_skin_mm},
                         {"risk", clearances_json(item.clearances)},
                         {"warnings", item.warnings}});
    if (options.json)
        std::cout << json_text(
                         nlohmann::json{{"case", the_case.code},
                                        {"title", title_of(the_case)},
                                        {"created", the_case.created},
                                        {"items", items},
                                        {"risk_structures", risk_structures_json(the_case.plan)},
                                        {"warnings", the_case.warnings},
                                        {"match", found ? nlohmann::json(evidence_of(*found)) : nlohmann::json()}})
                  << '\n';
    if (!options.picture.empty()) {
        write_png(render_scene(scene_of_fit(model, view), view_of_plan(drawing.drawing)), options.picture,
                  ReadableBy::owner);
        if (!options.json) fmt::print("{}\n", options.picture.string());
        return 0;
    }
    if (options.json) return 0;
    fmt::print("{}\n", title_of(the_case));
    for (const auto& warning : the_case.warnings) warn(warning);
    if (const auto report = options.case_folder / "report.html"; std::filesystem::exists(report))
        fmt::print("Report: {}\n", report.string());
    if (!options.landmarks.empty()) return run_landmarks(options, drawing, *cloud, model);
    if (!display_is_there())
        throw DeviceError("Display", "no window can be opened here",
                          "Start the program in a desktop session, or give --picture FILE.png of `planlight review`.");
    show_model(model, view,
               settings_of_window(options.recorded.language, options.recorded.theme, read_site_settings()));
    return 0;
}

}  // namespace

Run add_review(CLI::App& app) {
    const auto options = std::make_shared<ReviewOptions>();
    ReviewOptions& o = *options;
    auto* sub = add_command(
        app, "review", "Look at a prepared case, or at a match on it, in the operator window; or at a recorded session",
        "review case --registration registration.json --cloud cloud.ply");
    sub->add_option("case", o.case_folder, "Case folder, or the recording of a session (.plrec)")->required();
    auto* match =
        sub->add_option("--registration", o.registration, "A match to look at (registration.json of `register`)");
    auto* cloud = sub->add_option(
        "--cloud", o.cloud,
        "The scan (.ply, mm): shown on the skin, coloured by distance, as it was matched, or to click on");
    auto* landmarks = sub->add_option(
        "--landmarks", o.landmarks,
        "Click landmarks on the skin and the scan, and keep them in this table (.csv) for `register --pairs`");
    landmarks->needs(cloud);
    sub->add_option("--view", o.view, "before or after the fine match, or error: how far off the match may be")
        ->check(CLI::IsMember({"before", "after", "error"}))
        ->capture_default_str()
        ->needs(match);
    sub->add_option("--picture", o.picture,
                    "Write a picture (.png) instead of opening a window; needs no display (of a recording, with "
                    "--show: of the window, which is then closed)")
        ->excludes(landmarks)
        ->check(png_file());
    sub->add_option(
        "--out", o.recorded.out,
        "Of a recording: folder for its page (time line, errors, events) and pictures (default: beside it)");
    sub->add_flag(
        "--show", o.recorded.show,
        "Of a recording: in a window, to be scrubbed and stepped through by its frames and events; nothing is "
        "written");
    sub->add_option("--at", o.recorded.at_s,
                    "Of a recording: picture of the frame nearest to so many seconds (with --show: begin there)")
        ->check(CLI::Range(0.0, 1e6));
    sub->add_option(
        "--case", o.recorded.case_folder,
        "Of a recording, with --at or --show: its case, to lay the plan over the pictures and to say how far off its "
        "light was at each place (default: where it was when it was recorded)");
    sub->add_option("--clip", o.recorded.clip_s, "Of a recording: a PNG for each frame kept from .. to .. seconds")
        ->expected(2)
        ->check(CLI::Range(0.0, 1e6));
    language_option(sub, o.recorded.language);
    theme_option(sub, o.recorded.theme);
    json_flag(sub, o.json);
    landmarks->excludes(sub->get_option("--json"));  // they are clicked in a window
    return [options] { return run_review(*options); };
}

}  // namespace planlight
