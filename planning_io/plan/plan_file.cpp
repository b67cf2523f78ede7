#include "planning_io/plan/plan_file.h"

#include <cmath>

#include "planning_io/files/content_hash.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_import.h"
#include "planning_io/plan/plan_markup.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema =
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
    "markups-schema-v1.0.3.json#";

[[noreturn]] void refuse(const fs::path& file, const std::string& name, const std::string& problem) {
    throw InputError(file, "\"" + name + "\" " + problem, "Correct this item of the plan.");
}

}  // namespace

void check_plan_numbers(const Plan& plan, const fs::path& file) {
    const auto check = [&](bool good, const std::string& name) {
        if (!good) refuse(file, name, "has a coordinate or a size that is not a finite number or is negative");
    };
    const auto size = [](double mm) { return std::isfinite(mm) && mm >= 0; };
    for (const auto& t : plan.trajectories)
        check(t.entry_in_ct.allFinite() && t.target_in_ct.allFinite() && size(t.diameter_mm), t.name);
    for (const auto& b : plan.boreholes)
        check(b.position_in_ct.allFinite() && size(b.diameter_mm) && size(b.depth_mm) &&
                  (!b.axis_in_ct || b.axis_in_ct->allFinite()),
              b.name);
    for (const auto& line : plan.osteotomy_lines)
        for (const auto& p : line.points_in_ct) check(p.allFinite(), line.name);
    for (const auto& c : plan.cut_planes)
        check(c.origin_in_ct.allFinite() && c.normal_in_ct.allFinite() && c.first_axis_in_ct.allFinite() &&
                  size(c.width_mm) && size(c.height_mm),
              c.name);
}

Plan read_plan(const fs::path& file_or_folder) {
    return import_plan(file_or_folder).plan;
}

namespace {

std::string text_of(const Plan& plan) {
    Json markups = Json::array();
    for (const auto& t : plan.trajectories) markups.push_back(markup_of(t));
    for (const auto& b : plan.boreholes) markups.push_back(markup_of(b));
    for (const auto& line : plan.osteotomy_lines) markups.push_back(markup_of(line));
    for (const auto& c : plan.cut_planes) markups.push_back(markup_of(c));
    return dump(Json{{"@schema", kSchema}, {"markups", std::move(markups)}});
}

}  // namespace

void write_plan(const Plan& plan, const fs::path& file) {
    check_plan_numbers(plan, file);
    write_safely(file, text_of(plan));
}

std::string hash_of(const Plan& plan) {
    std::string text = text_of(plan);
    for (const auto& structure : plan.risk_structures)
        text += structure.name + '\n' + hash_of(structure.surface) + '\n';
    return content_hash(text);
}

std::vector<Eigen::Vector3d> points_of(const Plan& plan) {
    std::vector<Eigen::Vector3d> points;
    for (const auto& t : plan.trajectories) points.insert(points.end(), {t.entry_in_ct, t.target_in_ct});
    for (const auto& b : plan.boreholes) points.push_back(b.position_in_ct);
    for (const auto& line : plan.osteotomy_lines)
        points.insert(points.end(), line.points_in_ct.begin(), line.points_in_ct.end());
    for (const auto& c : plan.cut_planes) points.push_back(c.origin_in_ct);
    return points;
}

}  // namespace planlight
