#include "app/live/case_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

std::optional<double> depth_of(const Plan& plan, const DrawnItem& item) {
    for (const auto& t : plan.trajectories)
        if (item.kind == StrokeKind::trajectory && t.name == item.name) return t.length_mm();
    for (const auto& b : plan.boreholes)
        if (item.kind == StrokeKind::borehole && b.name == item.name && b.depth_mm > 0) return b.depth_mm;
    return std::nullopt;
}

std::vector<PlanRow> rows_of(const Plan& plan, const PlanDrawing& drawing) {
    std::vector<PlanRow> rows;
    for (std::size_t i = 0; i < drawing.items.size(); ++i) {
        const DrawnItem& item = drawing.items[i];
        PlanRow row;
        row.name = item.label.empty() ? item.name : item.label;
        row.depth_mm = depth_of(plan, item);
        for (const auto& stroke : drawing.strokes)
            if (stroke.item == static_cast<int>(i) && stroke.kind == item.kind) {
                row.colour = stroke.colour;
                break;
            }
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace

OperatorModel model_of_case(const Case& the_case, const CaseDrawing& drawing) {
    OperatorModel model;
    const Plan& plan = the_case.plan;
    model.case_title = "Case " + the_case.code;
    const auto counted = [](std::size_t count, const char* one, const char* many) {
        return fmt::format("{} {}", count, count == 1 ? one : many);
    };
    model.case_subtitle =
        fmt::format("{} \u00b7 {}, {}, {}", the_case.created.substr(0, 10),
                    counted(plan.osteotomy_lines.size() + plan.cut_planes.size(), "cutting line", "cutting lines"),
                    counted(plan.boreholes.size(), "borehole", "boreholes"),
                    counted(plan.trajectories.size(), "trajectory", "trajectories"));
    model.steps.fill(StepState::waiting);
    model.steps[0] = StepState::done;
    model.scene.skin = std::make_shared<TriangleMesh>(the_case.skin);
    model.scene.plan = std::make_shared<PlanDrawing>(drawing.drawing);
    model.rows = rows_of(plan, drawing.drawing);
    for (const auto& warning : the_case.warnings) model.evidence.push_back("Warning: " + warning);
    model.status = {StatusKind::dark, "Nothing is projected.", {}};
    for (auto* button : {&model.scan, &model.do_register, &model.track, &model.stop}) *button = {false, "no rig"};
    return model;
}

std::vector<double> predicted_errors_mm(const Plan& plan, const RegistrationResult& found) {
    std::vector<double> errors;
    const auto add = [&](const std::vector<Eigen::Vector3d>& points_in_ct) {
        double worst = 0;
        for (const auto& p : points_in_ct) worst = std::max(worst, predicted_error(found.covariance, p).bound_95_mm);
        errors.push_back(worst);
    };
    for (const auto& line : plan.osteotomy_lines) add(line.points_in_ct);
    for (const auto& b : plan.boreholes)
        add({b.position_in_ct, b.position_in_ct + b.depth_mm * b.axis_in_ct.value_or(Eigen::Vector3d::Zero())});
    for (const auto& t : plan.trajectories) add({t.entry_in_ct, t.target_in_ct});
    for (const auto& c : plan.cut_planes) add({c.origin_in_ct});
    return errors;
}

std::vector<std::string> evidence_of(const RegistrationResult& result) {
    std::vector<std::string> lines;
    lines.push_back(fmt::format("Residual {:.2f} mm rms; {:.0f} % of {} points within {:.1f} mm of the skin.",
                                result.residual_rms_mm, 100 * result.inlier_fraction, result.points,
                                result.inlier_distance_mm));
    lines.push_back(fmt::format("Next best other pose fits {:.1f} times worse; {} independent bases agree.",
                                result.runner_up_ratio, result.agreeing_bases));
    lines.push_back(fmt::format("The skin lies {:.1f} mm {} that of the CT, and has moved by {:.1f} mm (rms).",
                                std::abs(result.skin_offset_mm), result.skin_offset_mm < 0 ? "inside of" : "outside of",
                                result.skin_movement_mm));
    lines.push_back(fmt::format("Found in {:.2f} s, refined in {:.0f} ms.", result.initial_match_s, 1000 * result.refine_s));
    lines.insert(lines.end(), result.reasons.begin(), result.reasons.end());
    return lines;
}

}  // namespace planlight
