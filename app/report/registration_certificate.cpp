#include "app/report/registration_certificate.h"

#include <fmt/format.h>

#include <cmath>

#include "app/case_model.h"
#include "app/windows/scene_view.h"
#include "planning_io/case/cloud_rig.h"
#include "planning_io/case/registration_file.h"
#include "planning_io/files/keep_to_owner.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/point_pairs_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

PageVerdict verdict_of(const RegistrationResult& found) {
    PageVerdict verdict{PageVerdict::Kind::good, "Yes: the match may be used.", found.reasons};
    if (found.verdict == Verdict::ask)
        verdict.kind = PageVerdict::Kind::look,
        verdict.words = "Ask: look whether the scan fits the skin before it is used.";
    if (found.verdict == Verdict::no)
        verdict.kind = PageVerdict::Kind::stop, verdict.words = "No: the patient was not found.";
    return verdict;
}

/// Which rig, which scan; what is not known is said.
ReportFacts facts_of(const RegistrationResult& found, const PointCloud* cloud) {
    std::string rig = "not known", scan = cloud ? fmt::format("{} points", cloud->size()) : "none: landmarks alone";
    if (found.rig) {
        rig = fmt::format("calibrated {}, {}", found.rig->rig.made_on, text_of(found.rig->verdict));
        if (!found.rig->capture_hash.empty()) scan += ", capture " + found.rig->capture_hash.substr(0, 8);
    }
    return {{"Rig", rig}, {"Scan", scan}};
}

DocumentTable items_of(const OperatorModel& model) {
    DocumentTable table{{{"Plan item"}, {"may be off by (95 %)"}}, {}};
    for (const PlanRow& row : model.rows) {
        const auto& off = row.predicted_error_mm;
        const Tone tone = !off                          ? Tone::plain
                          : *off <= model.warn_above_mm ? Tone::good
                          : *off <= model.stop_above_mm ? Tone::look
                                                        : Tone::stop;
        const char* sign = tone == Tone::good ? "✓" : tone == Tone::look ? "⚠" : "✗";
        table.rows.push_back({{row.name}, {off ? fmt::format("{} {:.1f} mm", sign, *off) : "not known", tone}});
    }
    return table;
}

DocumentFigures pictures_of(const OperatorModel& model, const SceneView& view, bool with_scan) {
    const auto picture = [&](FitView shown) { return render_scene(scene_of_fit(model, shown), view, 960, 720); };
    std::vector<ReportPicture> pictures;
    if (with_scan) {
        pictures.push_back(
            {"Before the fine match", "The scan on the skin, coloured by its distance.", picture(FitView::before)});
        pictures.push_back({"After it", "The same points. They must lie on the skin, above all round the plan.",
                            picture(FitView::after)});
    }
    pictures.push_back({"How far off the match may be",
                        "95 % bound at every point of the skin; deeper points may be further off.",
                        picture(FitView::predicted_error)});
    return figures_of(pictures);
}

/// On a disk without permissions the match is kept all the same.
void keep_if_possible(const fs::path& folder) {
    try {
        keep_to_owner(folder);
    } catch (const DiskError&) {
    }
}

}  // namespace

Document certificate_of(const Case& the_case, const CaseDrawing& drawing, const RegistrationResult& found,
                        const std::shared_ptr<const PointCloud>& cloud) {
    OperatorModel model = model_of_case(the_case, drawing);
    show_match(the_case, found, cloud, model);
    model.scene.on_paper = true;
    Document document{"Match: " + title_of(the_case)};
    document.verdict = verdict_of(found);
    ReportFacts facts = facts_of(the_case);
    const ReportFacts of_match = facts_of(found, cloud.get());
    facts.insert(facts.end(), of_match.begin(), of_match.end());
    document.facts = with_program(facts);
    for (const std::string& line : evidence_of(found)) document.blocks.emplace_back(DocumentText{line});
    if (found.verdict != Verdict::no) {
        document.blocks.emplace_back(items_of(model));
        document.blocks.emplace_back(DocumentText{
            "These bounds hold for skin that moved here and there. They cannot know of skin that was pulled along as a "
            "whole since the CT (by gravity, tape, a retractor): it looks like a head that moved. Look at the light on "
            "a place where skin lies close on bone, such as the bridge of the nose."});
        document.blocks.emplace_back(pictures_of(model, view_of_plan(drawing.drawing), cloud != nullptr));
    }
    document.signed_by = {"Matched by", "Looked at and accepted by"};
    document.foot = fmt::format("Case {}. {}", the_case.code, foot_of_program());
    return document;
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
            keep_if_possible(filled);  // the face is in it
            if (cloud)
                write_cloud(*cloud, filled / "cloud.ply", {},
                            found.rig ? comments_of(*found.rig) : std::vector<std::string>{});
            if (!landmarks.empty()) write_point_pairs(landmarks, filled / "landmarks.csv");
            write_registration(found, filled / "registration.json");
            keep_if_possible(filled);
        });
    } catch (...) {
        std::error_code ignored;
        fs::remove(kept, ignored);  // empty: half a match is none
        throw;
    }
    return kept;
}

}  // namespace planlight
