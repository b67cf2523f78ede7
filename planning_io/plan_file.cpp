#include "planning_io/plan_file.h"

#include <algorithm>
#include <cmath>

#include "planning_io/plan_markup.h"
#include "planning_io/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema =
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#";

/// The minor version of the schema 1.0.x that the file names.
int schema_minor(const JsonValue& root) {
    const std::string schema = root.at("@schema").text();
    const std::string before = "markups-schema-v1.0.";
    const auto at = schema.find(before);
    if (at == std::string::npos || at + before.size() >= schema.size() || !std::isdigit(static_cast<unsigned char>(schema[at + before.size()])))
        root.at("@schema").refuse("is \"" + schema + "\", not a 3D Slicer markups schema 1.0.x", "Save the plan from 3D Slicer as .mrk.json.");
    return schema[at + before.size()] - '0';
}

void append_file(Plan& plan, const fs::path& file) {
    const Json json = parse_json(read_whole(file), file);
    const JsonValue root(json, file);
    const int minor = schema_minor(root);
    const JsonValue markups = root.at("markups");
    for (std::size_t i = 0; i < markups.size(); ++i) append_markup(plan, markups[i], minor >= 3);
}

[[noreturn]] void refuse(const fs::path& file, const std::string& name, const std::string& problem) {
    throw InputError(file, "\"" + name + "\" " + problem, "Correct this item of the plan.");
}

void check_numbers(const Plan& plan, const fs::path& file) {
    const auto check = [&](bool good, const std::string& name) {
        if (!good) refuse(file, name, "has a coordinate or a size that is not a finite number or is negative");
    };
    const auto size = [](double mm) { return std::isfinite(mm) && mm >= 0; };
    for (const auto& t : plan.trajectories) check(t.entry_in_ct.allFinite() && t.target_in_ct.allFinite() && size(t.diameter_mm), t.name);
    for (const auto& b : plan.boreholes)
        check(b.position_in_ct.allFinite() && size(b.diameter_mm) && size(b.depth_mm) && (!b.axis_in_ct || b.axis_in_ct->allFinite()), b.name);
    for (const auto& line : plan.osteotomy_lines)
        for (const auto& p : line.points_in_ct) check(p.allFinite(), line.name);
    for (const auto& c : plan.cut_planes)
        check(c.origin_in_ct.allFinite() && c.normal_in_ct.allFinite() && c.first_axis_in_ct.allFinite() && size(c.width_mm) && size(c.height_mm), c.name);
}

}  // namespace

Plan read_plan(const fs::path& file_or_folder) {
    Plan plan;
    if (!fs::is_directory(file_or_folder)) {
        append_file(plan, file_or_folder);
        return plan;
    }
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(file_or_folder))
        if (entry.path().filename().string().ends_with(".mrk.json")) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    if (files.empty()) throw InputError(file_or_folder, "holds no .mrk.json file", "Save the plan's markups from 3D Slicer into this folder.");
    for (const auto& file : files) append_file(plan, file);
    return plan;
}

void write_plan(const Plan& plan, const fs::path& file) {
    check_numbers(plan, file);
    Json markups = Json::array();
    for (const auto& t : plan.trajectories) markups.push_back(markup_of(t));
    for (const auto& b : plan.boreholes) markups.push_back(markup_of(b));
    for (const auto& line : plan.osteotomy_lines) markups.push_back(markup_of(line));
    for (const auto& c : plan.cut_planes) markups.push_back(markup_of(c));
    write_safely(file, dump(Json{{"@schema", kSchema}, {"markups", std::move(markups)}}));
}

std::vector<Eigen::Vector3d> points_of(const Plan& plan) {
    std::vector<Eigen::Vector3d> points;
    for (const auto& t : plan.trajectories) points.insert(points.end(), {t.entry_in_ct, t.target_in_ct});
    for (const auto& b : plan.boreholes) points.push_back(b.position_in_ct);
    for (const auto& line : plan.osteotomy_lines) points.insert(points.end(), line.points_in_ct.begin(), line.points_in_ct.end());
    for (const auto& c : plan.cut_planes) points.push_back(c.origin_in_ct);
    return points;
}

}  // namespace planlight
