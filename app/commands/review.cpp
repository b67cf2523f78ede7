#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/console.h"
#include "app/live/case_model.h"
#include "app/live/live_window.h"
#include "app/windows/scene_view.h"
#include "planning_io/case_folder.h"
#include "planning_io/image_file.h"
#include "planning_io/mesh_file.h"
#include "planning_io/recording_files.h"

namespace planlight {

namespace {

void set_status(const RegistrationResult& found, OperatorModel& model) {
    if (found.verdict == Verdict::yes) {
        model.status = {StatusKind::ready, "The patient was found. Nothing is projected.", {}};
    } else if (found.verdict == Verdict::ask) {
        model.status = {StatusKind::check, "Not sure: look whether the scan fits the skin.", found.reasons};
    } else {
        model.status = {StatusKind::refused, "The patient was not found.", found.reasons};
    }
}

}  // namespace

int run_review(const ReviewOptions& options) {
    const Case the_case = read_case(options.case_folder);
    const CaseDrawing drawing(the_case);
    OperatorModel model = model_of_case(the_case, drawing);
    std::optional<RegistrationResult> found;
    if (!options.registration.empty()) {
        found = read_registration(options.registration);
        std::shared_ptr<const PointCloud> cloud;
        if (!options.cloud.empty()) cloud = std::make_shared<PointCloud>(read_cloud(options.cloud, {1, true}));
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
                         {"warnings", item.warnings}});
    if (options.json)
        std::cout << nlohmann::json{{"case", the_case.code},
                                    {"created", the_case.created},
                                    {"items", items},
                                    {"warnings", the_case.warnings},
                                    {"match", found ? nlohmann::json(evidence_of(*found)) : nlohmann::json()}}.dump(2)
                  << '\n';
    if (!options.picture.empty()) {
        write_png(render_scene(scene_of_fit(model, view), view_of_plan(drawing.drawing)), options.picture);
        if (!options.json) fmt::print("{}\n", options.picture.string());
        return 0;
    }
    if (options.json) return 0;
    for (const auto& warning : the_case.warnings) warn(warning);
    if (const auto report = options.case_folder / "report.html"; std::filesystem::exists(report))
        fmt::print("Report: {}\n", report.string());
    show_model(model, view);
    return 0;
}

}  // namespace planlight
