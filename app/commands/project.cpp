#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/console.h"
#include "app/session.h"
#include "planning_io/image_file.h"
#include "planning_io/recording_files.h"
#include "planning_io/rig_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// The pose to draw for: refused when there is none, as the live session is dark then.
RigidTransform pose_to_draw(const ProjectOptions& options) {
    if (options.poses.empty()) return RigidTransform::Identity();
    const auto poses = read_poses(options.poses);
    const int last = static_cast<int>(poses.size()) - 1;
    const int frame = options.frame < 0 ? last : options.frame;
    if (frame < 0 || frame > last)
        throw InputError(options.poses, fmt::format("there is no frame {} (the file has {})", frame, poses.size()),
                         "Give --frame between 0 and the number of frames less one.");
    const TrackedPose& pose = poses[static_cast<std::size_t>(frame)];
    if (!pose.rig_from_patient)
        throw CheckFailedError(fmt::format("frame {} has no pose: {}", frame, pose.reason),
                               "Nothing is drawn without a pose; choose another frame.");
    return *pose.rig_from_patient;
}

void check_verdict(const RegistrationResult& registration, const ProjectOptions& options) {
    const bool usable = registration.verdict == Verdict::yes || (registration.verdict == Verdict::ask && options.confirmed);
    if (usable) return;
    throw CheckFailedError(fmt::format("the registration may not be used: {}", fmt::join(registration.reasons, "; ")),
                           registration.verdict == Verdict::ask
                               ? "Look at the overlay on landmarks and give --confirmed, or scan again."
                               : "Scan again.");
}

}  // namespace

int run_project(const ProjectOptions& options) {
    const Case the_case = read_case(options.case_folder);
    const RigCalibration rig = read_rig(options.rig);
    const RegistrationResult registration = read_registration(options.registration);
    check_verdict(registration, options);
    const RigidTransform rig_from_patient = pose_to_draw(options);
    const CaseDrawing drawing(the_case);
    const DrawingRenderer renderer(drawing.skin, rig.projector);
    const RgbImage picture =
        renderer.render(drawing.drawing, rig_from_patient * registration.patient_from_ct, rig_from_patient);  // T_global
    write_png(picture, options.out);
    const auto lit = std::count_if(picture.pixels.begin(), picture.pixels.end(),
                                   [](const Rgb& p) { return p[0] + p[1] + p[2] > 0; });
    nlohmann::json items = nlohmann::json::array();
    for (const auto& item : drawing.drawing.items) {
        items.push_back({{"name", item.name},
                         {"label", item.label},
                         {"distance_to_skin_mm", item.distance_to_skin_mm},
                         {"warnings", item.warnings}});
        for (const auto& warning : item.warnings) warn(warning);
    }
    if (options.json)
        std::cout << nlohmann::json{{"picture", options.out.string()}, {"lit_pixels", lit}, {"items", items}}.dump(2)
                  << '\n';
    else fmt::print("{} items in {} ({} lit pixels).\n", items.size(), options.out.string(), lit);
    return 0;
}

}  // namespace planlight
