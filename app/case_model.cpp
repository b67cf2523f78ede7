#include "app/case_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "app/belonging.h"
#include "app/windows/orientation.h"
#include "projection/mid_plane.h"

namespace planlight {
namespace {

/// Of the drawing's `n`-th item of its kind: names may be the same, or none, but the order is the plan's.
std::optional<double> depth_of(const Plan& plan, StrokeKind kind, std::size_t n) {
    if (kind == StrokeKind::trajectory) return plan.trajectories.at(n).length_mm();
    if (kind == StrokeKind::borehole && plan.boreholes.at(n).depth_mm > 0) return plan.boreholes[n].depth_mm;
    return std::nullopt;
}

std::vector<PlanRow> rows_of(const Plan& plan, const PlanDrawing& drawing) {
    std::vector<PlanRow> rows;
    std::map<StrokeKind, std::size_t> of_kind;
    for (std::size_t i = 0; i < drawing.items.size(); ++i) {
        const DrawnItem& item = drawing.items[i];
        PlanRow row;
        const std::size_t told = std::max<std::size_t>(1, warnings_in(item.clearances));
        row.risk.assign(item.clearances.begin(),
                        item.clearances.begin() + static_cast<long>(std::min(told, item.clearances.size())));
        row.depth_mm = depth_of(plan, item.kind, of_kind[item.kind]++);
        for (const auto& stroke : drawing.strokes)
            if (stroke.item == static_cast<int>(i) && stroke.kind == item.kind) {
                row.colour = stroke.colour;
                break;
            }
        rows.push_back(std::move(row));
    }
    name_rows(drawing, rows);
    return rows;
}

/// Where the plan meets the skin, or begins: not the targets in the depth, which may lie across the middle.
std::vector<Eigen::Vector3d> points_on_skin(const Plan& plan) {
    std::vector<Eigen::Vector3d> points;
    for (const auto& line : plan.osteotomy_lines)
        points.insert(points.end(), line.points_in_ct.begin(), line.points_in_ct.end());
    for (const auto& b : plan.boreholes) points.push_back(b.position_in_ct);
    for (const auto& t : plan.trajectories) points.push_back(t.entry_in_ct);
    for (const auto& c : plan.cut_planes) points.push_back(c.origin_in_ct);
    return points;
}

/// Of landmarks, of a scan of skin, or of what was taken for skin among cloth.
std::string evidence_of_fit(const RegistrationResult& result) {
    if (!(result.inlier_distance_mm > 0))
        return fmt::format("Residual {:.2f} mm rms, of {} landmarks.", result.residual_rms_mm, result.points);
    const std::size_t judged = result.judged_points > 0 ? result.judged_points : result.points;  // (of an older file)
    if (!result.skin_fraction)
        return fmt::format("Residual {:.2f} mm rms; {:.0f} % of {} points within {:.1f} mm of the skin.",
                           result.residual_rms_mm, 100 * result.inlier_fraction, judged, result.inlier_distance_mm);
    return fmt::format(
        "Residual {:.2f} mm rms; {:.0f} % of the {} points taken for skin ({:.0f} % of the scan's surface) within "
        "{:.1f} mm of it.",
        result.residual_rms_mm, 100 * result.inlier_fraction, judged, 100 * *result.skin_fraction,
        result.inlier_distance_mm);
}

}  // namespace

std::string side_of_plan(const Plan& plan, const SkinSurface& skin) {
    constexpr double kMiddle_mm = 10;                   // so near to the middle nothing is said to lie on a side
    constexpr double kEdge_mm = 2, kMostAtEdge = 0.04;  // more of the skin there: the volume was cut off
    const auto& vertices = skin.mesh().vertices_in_ct;
    const std::vector<Eigen::Vector3d> points = points_on_skin(plan);
    if (points.empty() || vertices.empty()) return {};
    const auto [low, high] =
        std::minmax_element(vertices.begin(), vertices.end(),
                            [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.x() < b.x(); });
    for (const double edge : {low->x(), high->x()}) {
        const auto at_edge = std::count_if(vertices.begin(), vertices.end(),
                                           [&](const Eigen::Vector3d& p) { return std::abs(p.x() - edge) < kEdge_mm; });
        if (static_cast<double>(at_edge) > kMostAtEdge * static_cast<double>(vertices.size())) return {};
    }
    const auto middle = find_mid_plane(skin);
    if (!middle) return {};
    bool left = false, right = false;
    for (const auto& p : points) {
        left = left || middle->left_mm(p) > kMiddle_mm;
        right = right || middle->left_mm(p) < -kMiddle_mm;
    }
    return left && right ? "BOTH SIDES" : left ? "LEFT" : right ? "RIGHT" : "MIDDLE";
}

std::vector<std::string> card_of(const Case& the_case, const SkinSurface& skin, bool anonymous) {
    std::vector<std::string> card{anonymous || the_case.names.patient.empty() ? the_case.code : the_case.names.patient};
    if (std::string side = side_of_plan(the_case.plan, skin); !side.empty()) card.push_back(std::move(side));
    return card;
}

void name_rows(const PlanDrawing& drawing, std::vector<PlanRow>& rows) {
    for (std::size_t i = 0; i < std::min(rows.size(), drawing.items.size()); ++i) {
        const DrawnItem& item = drawing.items[i];
        const std::string label = item.label.empty() ? item.name : item.label;
        const std::string code = item.lit_by_code ? item.code + "  " : "";
        rows[i].name = code + label;
        rows[i].bare = !item.labelled;
        // The depth is the last of the figures beside the name.
        const std::size_t last = label.rfind("  ");
        const bool figures = label.size() > item.name.size() && last != std::string::npos && last >= item.name.size();
        rows[i].short_name = code + (figures && rows[i].depth_mm ? label.substr(0, last) : label);
    }
}

std::vector<std::string> unlit_warnings(const PlanDrawing& drawing) {
    std::vector<std::string> sentences;
    for (const DrawnItem& item : drawing.items)
        if (!item.unlit_warning.empty())
            sentences.push_back(
                fmt::format("{}: \"{}\" has no room in the light beside it", item.name, item.unlit_warning));
    return sentences;
}

long bare_items(const PlanDrawing& drawing) {
    return std::count_if(drawing.items.begin(), drawing.items.end(),
                         [](const DrawnItem& item) { return !item.labelled; });
}

std::vector<std::string> evidence_of_labels(const PlanDrawing& drawing) {
    std::vector<std::string> sentences;
    const long bare = bare_items(drawing);
    if (bare > 0)
        sentences.push_back(fmt::format(
            "The plan is crowded: {} of {} items have no name beside their light. Light one alone to see which it is.",
            bare, drawing.items.size()));
    const auto unlit = unlit_warnings(drawing);
    sentences.insert(sentences.end(), unlit.begin(), unlit.end());
    return sentences;
}

OperatorModel model_of_case(const Case& the_case, const CaseDrawing& drawing) {
    OperatorModel model;
    const Plan& plan = the_case.plan;
    const CaseNames& names = the_case.names;
    model.case_title = names.patient.empty() ? "Case " + the_case.code : names.patient;
    model.case_plan = names.title + (names.title.empty() || names.plan.empty() ? "" : ", ") + names.plan;
    if (model.case_plan.empty()) model.case_plan = "Plan without a name";
    if (!names.plan_version.empty()) model.case_plan += ", version " + names.plan_version;
    if (!names.series_date.empty()) model.case_plan += " \u00b7 series of " + names.series_date;
    model.case_side = side_of_plan(plan, drawing.skin);
    const auto counted = [](std::size_t count, const char* one, const char* many) {
        return fmt::format("{} {}", count, count == 1 ? one : many);
    };
    model.case_subtitle =
        fmt::format("{} of {} \u00b7 {}, {}, {}", the_case.code, the_case.created.substr(0, 10),
                    counted(plan.osteotomy_lines.size() + plan.cut_planes.size(), "cutting line", "cutting lines"),
                    counted(plan.boreholes.size(), "borehole", "boreholes"),
                    counted(plan.trajectories.size(), "trajectory", "trajectories"));
    model.steps.fill(StepState::waiting);
    model.steps[0] = StepState::done;
    model.scene.skin = std::make_shared<TriangleMesh>(the_case.skin);
    model.scene.plan = std::make_shared<PlanDrawing>(drawing.drawing);
    if (!plan.risk_structures.empty())
        model.scene.risk_structures = std::make_shared<std::vector<RiskStructure>>(plan.risk_structures);
    model.rows = rows_of(plan, drawing.drawing);
    if (drawing.settings.up_in_ct.norm() > 0) model.surgeon_view = surgeon_view(drawing.settings.up_in_ct);
    for (const auto& warning : the_case.warnings) model.evidence.push_back("Warning: " + warning);
    model.status = {StatusKind::dark, "Nothing is projected.", {}};
    for (auto* button : {&model.scan, &model.do_register, &model.track, &model.stop}) *button = {false, "no rig"};
    return model;
}

std::vector<double> predicted_errors_mm(const Plan& plan, const RegistrationResult& found) {
    std::vector<double> errors;
    const auto add = [&](const std::vector<Eigen::Vector3d>& points_in_ct) {
        double worst = 0;
        for (const auto& p : points_in_ct)
            worst = std::max(worst, covered_by_mm(found.skin, p) ? std::numeric_limits<double>::infinity()
                                                                 : predicted_light_mm(found, p));
        errors.push_back(worst);
    };
    for (const auto& line : plan.osteotomy_lines) add(line.points_in_ct);
    for (const auto& b : plan.boreholes)
        add({b.position_in_ct, b.position_in_ct + b.depth_mm * b.axis_in_ct.value_or(Eigen::Vector3d::Zero())});
    for (const auto& t : plan.trajectories) add({t.entry_in_ct, t.target_in_ct});
    for (const auto& c : plan.cut_planes) add({c.origin_in_ct});
    return errors;
}

std::shared_ptr<const std::vector<float>> predicted_on_skin_mm(const TriangleMesh& skin,
                                                               const RegistrationResult& found) {
    auto errors = std::make_shared<std::vector<float>>();
    errors->reserve(skin.vertices_in_ct.size());
    const double hidden_mm =
        found.rig ? found.rig->hidden_light_mm : 0;  // over the scanned skin: at each vertex it would take a second
    for (const auto& p : skin.vertices_in_ct)
        errors->push_back(static_cast<float>(predicted_light_mm(found, p, hidden_mm)));
    return errors;
}

std::shared_ptr<const std::vector<float>> distances_to_skin_mm(const PointCloud& cloud,
                                                               const RigidTransform& ct_from_rig, const SkinLut& lut,
                                                               double skin_offset_mm) {
    auto distances = std::make_shared<std::vector<float>>();
    distances->reserve(cloud.size());
    for (const auto& p_in_rig : cloud.points_in_rig) {
        const auto distance = lut.signed_distance(ct_from_rig * p_in_rig);
        distances->push_back(distance ? static_cast<float>(std::abs(distance->mm - skin_offset_mm))
                                      : std::numeric_limits<float>::infinity());
    }
    return distances;
}

std::vector<std::string> evidence_of(const RegistrationResult& result) {
    std::vector<std::string> lines;
    lines.push_back(evidence_of_fit(result));
    if (result.runner_up_ratio > 0 || result.agreeing_bases > 0)
        lines.push_back(fmt::format("Next best other pose fits {:.1f} times worse; {} independent bases agree.",
                                    result.runner_up_ratio, result.agreeing_bases));
    if (result.mirror_ratio > 0)
        lines.push_back(fmt::format("The mirror image fits {:.1f} times worse; size of the head {:+.1f} ± {:.1f} %.",
                                    result.mirror_ratio, 100 * (1 / result.scale - 1), 100 * result.scale_sigma));
    if (result.landmarks_off_mm)
        lines.push_back(fmt::format("The farthest landmark lies {:.1f} mm from where the match puts it.",
                                    *result.landmarks_off_mm));
    if (result.moved_in_scan_mm)
        lines.push_back(
            fmt::format("The patient moved by at most {:.2f} mm during the scan.", *result.moved_in_scan_mm));
    if (result.blocked_fraction)
        lines.push_back(fmt::format("{:.0f} % of the scan was seen through what is body in the CT.",
                                    100 * *result.blocked_fraction));
    if (result.skin_offset_mm && result.skin_movement_mm)
        lines.push_back(fmt::format("The skin lies {:.1f} mm {} that of the CT, and has moved by {:.1f} mm (rms).",
                                    std::abs(*result.skin_offset_mm),
                                    *result.skin_offset_mm < 0 ? "inside of" : "outside of", *result.skin_movement_mm));
    lines.push_back(
        fmt::format("Found in {:.2f} s, refined in {:.0f} ms.", result.initial_match_s, 1000 * result.refine_s));
    lines.insert(lines.end(), result.reasons.begin(), result.reasons.end());
    return lines;
}

void show_match(const Case& the_case, const RegistrationResult& found, const std::shared_ptr<const PointCloud>& cloud,
                OperatorModel& model) {
    model.evidence = evidence_of(found);
    model.fit = std::nullopt;
    if (found.verdict == Verdict::no) return;
    const auto predicted = predicted_errors_mm(the_case.plan, found);
    for (std::size_t i = 0; i < model.rows.size() && i < predicted.size(); ++i)
        if (std::isfinite(predicted[i]) && predicted[i] > 0) model.rows[i].predicted_error_mm = predicted[i];
    FitViews fit;
    fit.before_ct_from_rig = found.initial_patient_from_ct.inverse();
    fit.predicted_mm = predicted_on_skin_mm(the_case.skin, found);
    model.scene.ct_from_rig = found.patient_from_ct.inverse();
    model.scene.cloud = cloud;
    if (cloud) {
        const double offset_mm = model.scene.skin_offset_mm = found.skin_offset_mm.value_or(0);
        model.scene.cloud_distance_mm = distances_to_skin_mm(*cloud, model.scene.ct_from_rig, the_case.lut, offset_mm);
        fit.before_distance_mm = distances_to_skin_mm(*cloud, fit.before_ct_from_rig, the_case.lut, offset_mm);
    }
    model.fit = fit;
}

}  // namespace planlight
