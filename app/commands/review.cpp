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

namespace planlight {

int run_review(const ReviewOptions& options) {
    const Case the_case = read_case(options.case_folder);
    const CaseDrawing drawing(the_case);
    const OperatorModel model = model_of_case(the_case, drawing);
    nlohmann::json items = nlohmann::json::array();
    for (const auto& item : drawing.drawing.items)
        items.push_back({{"name", item.name},
                         {"label", item.label},
                         {"distance_to_skin_mm", item.distance_to_skin_mm},
                         {"warnings", item.warnings}});
    if (options.json)
        std::cout << nlohmann::json{{"case", the_case.code}, {"created", the_case.created},
                                    {"items", items}, {"warnings", the_case.warnings}}.dump(2) << '\n';
    if (!options.picture.empty()) {
        write_png(render_scene(model.scene, view_of_plan(drawing.drawing)), options.picture);
        if (!options.json) fmt::print("{}\n", options.picture.string());
        return 0;
    }
    if (options.json) return 0;
    for (const auto& warning : the_case.warnings) warn(warning);
    if (const auto report = options.case_folder / "report.html"; std::filesystem::exists(report))
        fmt::print("Report: {}\n", report.string());
    show_case(the_case, drawing);
    return 0;
}

}  // namespace planlight
