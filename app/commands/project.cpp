#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/belonging.h"
#include "app/case_model.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/surgeon_option.h"
#include "app/console.h"
#include "app/json_text.h"
#include "app/report/clearance_json.h"
#include "app/session.h"
#include "app/site_settings.h"
#include "planning_io/case/poses_file.h"
#include "planning_io/case/registration_file.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/image_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

struct ProjectOptions {
    Path case_folder, rig, registration, poses, out;
    std::optional<int> frame;  ///< of the poses; empty: the last
    std::string surgeon, item, others = "dim";
    bool confirmed = false, json = false;
};

/// The pose to draw for: refused when there is none, as the live session is dark then.
RigidTransform pose_to_draw(const ProjectOptions& options) {
    if (options.poses.empty()) return RigidTransform::Identity();
    const auto poses = read_poses(options.poses);
    const int last = static_cast<int>(poses.size()) - 1;
    const int frame = options.frame.value_or(last);
    if (frame < 0 || frame > last)
        throw InputError(options.poses, fmt::format("there is no frame {} (the file has {})", frame, poses.size()),
                         "Give --frame between 0 and the number of frames less one.");
    const TrackedPose& pose = poses[static_cast<std::size_t>(frame)];
    if (!pose.rig_from_patient)
        throw CheckFailedError(fmt::format("frame {} has no pose: {}", frame, pose.reason),
                               "Nothing is drawn without a pose; choose another frame.");
    constexpr double kMost_mm = 2;           // beyond it a session's light goes out
    constexpr double kMostUnnoticed_mm = 3;  // beyond it a session's light is not green
    if (!(pose.bound_95_mm > 0))
        warn(fmt::format("how well the pose of frame {} is known stands not in the file", frame));
    if (pose.external_reliability_mm > kMostUnnoticed_mm)
        warn(
            fmt::format("a marker that slipped by 1 mm could move the plan of frame {} by {:.1f} mm before the others "
                        "show it: track with more markers in sight",
                        frame, pose.external_reliability_mm));
    warn(
        "the light of recorded poses was not measured: a camera or a camera bar that was knocked since the scan moves "
        "it without a sign (`planlight check` asks the rig, a session the light)");
    if (pose.bound_95_mm > kMost_mm || pose.markers_left + pose.markers_right < 3)
        throw CheckFailedError(fmt::format("the pose of frame {} is not known well enough: to {:.1f} mm, by {} markers "
                                           "in the left picture and {} in the right",
                                           frame, pose.bound_95_mm, pose.markers_left, pose.markers_right),
                               "Choose another frame, or track the patient with more markers in sight.");
    return *pose.rig_from_patient;
}

void check_verdict(const RegistrationResult& registration, const ProjectOptions& options) {
    const bool usable =
        registration.verdict == Verdict::yes || (registration.verdict == Verdict::ask && options.confirmed);
    if (usable) return;
    const bool bad_rig = registration.rig && registration.rig->verdict == RigState::Verdict::not_trusted;
    const bool advised = bad_rig && !registration.rig->remedy.empty();  // and it is among the reasons
    throw CheckFailedError(fmt::format("the registration may not be used: {}", fmt::join(registration.reasons, "; ")),
                           registration.verdict == Verdict::ask
                               ? "Look at the overlay on landmarks and give --confirmed, or scan again."
                               : (advised ? registration.rig->remedy : "Scan again."));
}

/// Files of other cases, rigs and scans are refused; what they do not say is said.
void check_belonging(const ProjectOptions& options, const Case& the_case, const RigCalibration& rig,
                     const RegistrationResult& registration) {
    std::vector<std::string> unknown;
    check_case(registration, the_case, options.registration, unknown);
    check_rig(registration, rig, options.registration, options.rig, unknown);
    if (!options.poses.empty())
        check_poses(read_poses_origin(options.poses), registration, rig, options.poses, options.confirmed, unknown);
    for (const std::string& what : unknown) warn(what);
}

/// The item of the moment by its name, and what becomes of the others.
RenderSettings brightness(const ProjectOptions& options, const PlanDrawing& drawing) {
    RenderSettings settings;
    if (options.item.empty()) return settings;
    std::string names;
    for (std::size_t i = 0; i < drawing.items.size(); ++i) {
        if (drawing.items[i].name == options.item) settings.item_of_moment = static_cast<int>(i);
        names += (i == 0 ? "\"" : ", \"") + drawing.items[i].name + "\"";
    }
    if (settings.item_of_moment < 0)
        throw InputError(options.case_folder, fmt::format("the plan has no item \"{}\"", options.item),
                         "Give --item one of " + names + ".");
    if (options.others == "hidden") settings.others = 0;
    return settings;
}

int run_project(const ProjectOptions& options) {
    const Case the_case = read_case(options.case_folder);
    const RigCalibration calibrated = read_rig(options.rig);
    const RegistrationResult registration = read_registration(options.registration);
    check_belonging(options, the_case, calibrated, registration);
    check_verdict(registration, options);
    const RigCalibration rig = rig_of_light(registration, calibrated, options.confirmed);
    const RigidTransform rig_from_patient = pose_to_draw(options);
    const CaseDrawing planned(the_case, drawing_settings(site_with(options.surgeon)));
    const CaseDrawing drawing(the_case, planned, registration.skin,  // on the skin as the scan found it
                              lit_by(rig, registration.patient_from_ct, planned.settings));
    const DrawingRenderer renderer(drawing.skin, rig.projector);
    RgbImage picture;
    const RenderCounts light =
        renderer.render_into(picture, drawing.drawing, rig_from_patient * registration.patient_from_ct,  // T_global
                             rig_from_patient, brightness(options, drawing.drawing));
    const auto lit = std::count_if(picture.pixels.begin(), picture.pixels.end(),
                                   [](const Rgb& p) { return p[0] + p[1] + p[2] > 0; });
    if (lit == 0)
        throw CheckFailedError(
            "nothing of the plan lies in the projector's light at this pose",
            "Turn the patient or the rig so that the plan's side of the head is lit, and scan again.");
    if (registration.rig && registration.rig->moved())
        warn(fmt::format("{}. {}", registration.rig->sentence, registration.rig->remedy));
    write_png(picture, options.out);
    nlohmann::json items = nlohmann::json::array();
    for (const auto& item : drawing.drawing.items) {
        items.push_back({{"name", item.name},
                         {"label", item.label},
                         {"lit_name", item.lit_name},
                         {"code", item.code},
                         {"lit_by_code", item.lit_by_code},
                         {"distance_to_skin_mm", item.distance_to_skin_mm},
                         {"risk", clearances_json(item.clearances)},
                         {"warnings", item.warnings}});
        for (const auto& warning : item.warnings) warn(warning);
        for (const auto& warning : risk_warnings(item.name, item.clearances)) warn(warning);
    }
    for (const auto& warning : unlit_warnings(drawing.drawing)) warn(warning);
    if (!registration.skin.known())
        warn(
            "the registration does not say where the scan found the skin: drawn on the CT's own. Where the light falls "
            "at a slant it lies aside by as much as the skin has moved. Scan from nearer, so that more points lie on "
            "skin, and register that scan.");
    for (const PartlyLitRing& ring : light.partly_lit)
        if (ring.item >= 0) items[static_cast<std::size_t>(ring.item)]["lit_share_of_circle"] = ring.lit_share;
    for (const auto& sentence : sentences(light.partly_lit, drawing.drawing)) warn(sentence);
    for (std::size_t i = 0; i < light.items.size(); ++i) items[i]["lit_share"] = light.items[i].lit_share();
    for (const auto& sentence : sentences_of_unlit(light, drawing.drawing)) warn(sentence);
    if (const auto sentence = sentence_of_labels(light, drawing.drawing); !sentence.empty()) warn(sentence);
    if (options.json)
        std::cout << json_text(nlohmann::json{{"case", the_case.code},
                                              {"title", title_of(the_case)},
                                              {"picture", options.out.string()},
                                              {"lit_pixels", lit},
                                              {"items", items}})
                  << '\n';
    else
        fmt::print(
            "{}\n{} of {} items in {} ({} lit pixels).\n", title_of(the_case),
            std::count_if(light.items.begin(), light.items.end(), [](const PointCounts& of) { return of.lit > 0; }),
            items.size(), options.out.string(), lit);
    return 0;
}

}  // namespace

Run add_project(CLI::App& app) {
    const auto options = std::make_shared<ProjectOptions>();
    ProjectOptions& o = *options;
    auto* sub = add_command(app, "project", "Case, registration and pose -> the projector's picture",
                            "project case --rig room/rig.json --registration registration.json --out light.png");
    sub->add_option("case", o.case_folder, "Case folder")->required();
    sub->add_option("--rig", o.rig, "rig.json")->required();
    sub->add_option("--registration", o.registration, "registration.json")->required();
    auto* poses = sub->add_option("--poses", o.poses, "poses.json (default: the patient has not moved since the scan)");
    sub->add_option("--frame", o.frame, "Which pose, from 0 (default: the last)")
        ->check(CLI::Range(0, 1000000000))
        ->needs(poses);
    sub->add_flag(
        "--confirmed", o.confirmed,
        "The overlay was looked at on landmarks (for the verdict `ask`, and for files that do not say of which "
        "scan they are)");
    surgeon_option(sub, o.surgeon);
    auto* item = sub->add_option("--item", o.item, "Name of the item that is worked on: bright, with its whole label");
    sub->add_option("--others", o.others, "The other items then: dim or hidden")
        ->capture_default_str()
        ->check(CLI::IsMember({"dim", "hidden"}))
        ->needs(item);
    sub->add_option("--out", o.out, "Picture to write (.png)")->required()->check(png_file());
    json_flag(sub, o.json);
    return [options] { return run_project(*options); };
}

}  // namespace planlight
