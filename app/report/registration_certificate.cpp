#include "app/report/registration_certificate.h"

#include <fmt/format.h>

#include <cmath>

#include "app/case_model.h"
#include "app/report/html_page.h"
#include "app/windows/scene_view.h"
#include "planning_io/case/cloud_rig.h"
#include "planning_io/case/registration_file.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/point_pairs_file.h"
#include "planning_io/surface/mesh_file.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

std::string verdict_html(const RegistrationResult& found) {
    std::string html =
        found.verdict == Verdict::yes ? "<div class=\"verdict yes\">&#10003; Yes: the match may be used.</div>"
        : found.verdict == Verdict::ask
            ? "<div class=\"verdict no\">&#9888; Ask: look whether the scan fits the skin before it is used.</div>"
            : "<div class=\"verdict no\">&#10007; No: the patient was not found.</div>";
    for (const std::string& reason : found.reasons) html += fmt::format("<p class=\"no\">{}</p>", xml_escaped(reason));
    return html;
}

std::string items_html(const OperatorModel& model) {
    std::string html = "<table><tr><th>Plan item</th><th>may be off by (95 %)</th></tr>";
    for (const PlanRow& row : model.rows) {
        const bool known = row.predicted_error_mm.has_value();
        const char* mark = !known                                           ? ""
                           : *row.predicted_error_mm <= model.warn_above_mm ? "&#10003;"
                           : *row.predicted_error_mm <= model.stop_above_mm ? "&#9888;"
                                                                            : "&#10007;";
        html += fmt::format("<tr><td>{}</td><td>{}</td></tr>", xml_escaped(row.name),
                            known ? fmt::format("{} {:.1f} mm", mark, *row.predicted_error_mm) : "not known");
    }
    return html + "</table>";
}

}  // namespace

void write_certificate_html(const Case& the_case, const CaseDrawing& drawing, const RegistrationResult& found,
                            const std::shared_ptr<const PointCloud>& cloud, const fs::path& file) {
    constexpr int kWidth = 960, kHeight = 720;
    OperatorModel model = model_of_case(the_case, drawing);
    show_match(the_case, found, cloud, model);
    model.scene.on_paper = true;
    std::string body = verdict_html(found);
    for (const std::string& line : evidence_of(found)) body += fmt::format("<p>{}</p>", xml_escaped(line));
    if (found.verdict != Verdict::no) {
        body += items_html(model);
        body +=
            "<p>These bounds hold for skin that moved here and there. They cannot know of skin that was pulled along "
            "as a whole "
            "since the CT (by gravity, tape, a retractor): it looks like a head that moved. Look at the light on a "
            "place "
            "where skin lies close on bone, such as the bridge of the nose.</p>";
        const SceneView view = view_of_plan(drawing.drawing);
        const auto picture = [&](FitView shown) {
            return render_scene(scene_of_fit(model, shown), view, kWidth, kHeight);
        };
        std::vector<ReportPicture> pictures;
        if (cloud) {
            pictures.push_back(
                {"Before the fine match", "The scan on the skin, coloured by its distance.", picture(FitView::before)});
            pictures.push_back({"After it", "The same points. They must lie on the skin, above all round the plan.",
                                picture(FitView::after)});
        }
        pictures.push_back({"How far off the match may be",
                            "95 % bound at every point of the skin; deeper points may be further off.",
                            picture(FitView::predicted_error)});
        body += html_figures(pictures, 2);
    }
    write_safely(file, html_page("Match: " + title_of(the_case), body, facts_of(the_case)));
}

fs::path keep_match(const RegistrationResult& found, const PointCloud* cloud, const std::vector<PointPair>& landmarks,
                    const fs::path& folder) {
    make_folder(folder);
    fs::path kept;
    for (int number = 1; kept.empty(); ++number) {
        const fs::path wanted = folder / fmt::format("{:04d}", number);
        if (make_new_folder(wanted)) kept = wanted;
    }
    try {
        write_folder_safely(kept, false, [&](const fs::path& filled) {
            if (cloud)
                write_cloud(*cloud, filled / "cloud.ply", {},
                            found.rig ? comments_of(*found.rig) : std::vector<std::string>{});
            if (!landmarks.empty()) write_point_pairs(landmarks, filled / "landmarks.csv");
            write_registration(found, filled / "registration.json");
        });
    } catch (...) {
        std::error_code ignored;
        fs::remove(kept, ignored);  // empty: half a match is none
        throw;
    }
    return kept;
}

}  // namespace planlight
