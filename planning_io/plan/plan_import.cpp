#include "planning_io/plan/plan_import.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "planning_io/files/check_exists.h"
#include "planning_io/files/one_line.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_fcsv.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_limits.h"
#include "planning_io/plan/plan_markup.h"
#include "planning_io/plan/plan_rtstruct.h"
#include "planning_io/plan/plan_shapes.h"
#include "planning_io/plan/plan_table.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr double kLeastAcross_mm = 2;  // a plan for a head; one in metres is 0.2 "mm" across
constexpr double kMostAcross_mm = 1000;

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

bool ends(const fs::path& file, const char* ending) {
    return lower(file.filename().string()).ends_with(ending);
}

/// The minor version of the schema 1.0.x that the file names.
int schema_minor(const JsonValue& root) {
    if (!root.find("@schema"))
        root.refuse("names no \"@schema\": it is no markups file of 3D Slicer",
                    "Save the plan from 3D Slicer as .mrk.json.");
    const std::string schema = root.at("@schema").text();
    const std::string before = "markups-schema-v1.0.";
    const auto at = schema.find(before);
    if (at == std::string::npos || at + before.size() >= schema.size() ||
        !std::isdigit(static_cast<unsigned char>(schema[at + before.size()])))
        root.at("@schema").refuse("is \"" + schema + "\", not a 3D Slicer markups schema 1.0.x",
                                  "Save the plan from 3D Slicer as .mrk.json.");
    return schema[at + before.size()] - '0';
}

/// How far the cubic spline through the points runs beside the straight lines, mm. 3D Slicer shows a curve so unless it
/// is told not to: even parameters, twice continuously differentiable (vtkCardinalSpline in a vtkParametricSpline), at
/// open ends without a slope.
double smooth_beside_straight_mm(const OsteotomyLine& line) {
    constexpr int kRounds = 40;  // each halves what is missing, and more
    const auto n = line.points_in_ct.size();
    if (n < 3) return 0;
    const auto& points = line.points_in_ct;
    std::vector<Eigen::Vector3d> slopes(n, Eigen::Vector3d::Zero());
    for (int round = 0; round < kRounds; ++round)
        for (std::size_t i = line.closed ? 0 : 1; i < (line.closed ? n : n - 1); ++i) {
            const std::size_t before = (i + n - 1) % n, after = (i + 1) % n;
            slopes[i] = (3 * (points[after] - points[before]) - slopes[before] - slopes[after]) / 4;
        }
    double most_mm = 0;
    for (std::size_t i = 0; i < (line.closed ? n : n - 1); ++i) {
        const Eigen::Vector3d &from = points[i], &to = points[(i + 1) % n], way = to - from;
        for (double t = 0.1; t < 0.95; t += 0.1) {
            const double to_go = 1 - t;
            const Eigen::Vector3d smooth = from * to_go * to_go * (1 + 2 * t) + to * t * t * (3 - 2 * t) +
                                           slopes[i] * t * to_go * to_go - slopes[(i + 1) % n] * t * t * to_go;
            const Eigen::Vector3d straight =
                from + std::clamp((smooth - from).dot(way) / way.squaredNorm(), 0., 1.) * way;
            most_mm = std::max(most_mm, (smooth - straight).norm());
        }
    }
    return most_mm;
}

/// The file does not say whether the curve was shown smooth. Empty where that makes no difference.
std::string note_on_curve(const OsteotomyLine& line) {
    constexpr double kSeen_mm = 0.5;
    const double aside_mm = smooth_beside_straight_mm(line);
    if (aside_mm <= kSeen_mm) return {};
    return fmt::format(
        "\"{}\" runs straight between its {} points. A smooth curve through them, as 3D Slicer shows one unless its "
        "curve type is linear, lies up to {:.1f} mm beside that: if that is meant, resample the curve there and save "
        "it again.",
        line.name, line.points_in_ct.size(), aside_mm);
}

PlanImport read_markups(const std::string& content, const fs::path& file, const PlanImportSettings& settings) {
    PlanImport read;
    const Json json = parse_json(content, file);
    const JsonValue root(json, file);
    const int minor = schema_minor(root);
    const JsonValue markups = root.at("markups");
    for (std::size_t i = 0; i < markups.size(); ++i) {
        append_markup(read.plan, markups[i], minor >= 3, plan_name_of(file));
        space_of_plan(space_named(markups[i].at("coordinateSystem").text()), settings, file, "", read);
        if (!markups[i].at("type").text().ends_with("Curve")) continue;
        if (std::string note = note_on_curve(read.plan.osteotomy_lines.back()); !note.empty())
            read.notes.push_back(std::move(note));
    }
    return read;
}

bool is_dicom(const std::string& content) {
    return content.size() >= 132 && content.compare(128, 4, "DICM") == 0;
}

/// Files that planning programs write beside their plans, and what to do with them.
void refuse_known_others(const std::string& content, const fs::path& file) {
    const auto refuse = [&](const std::string& what, const std::string& remedy) {
        throw InputError(file, "is " + what + ", not a plan", remedy);
    };
    if (content.starts_with("PK\x03\x04"))
        refuse("a spreadsheet or another zip archive", "Save its table as CSV, or unpack it.");
    if (content.starts_with("# Annotation file") || ends(file, ".acsv"))
        refuse("an annotation of 3D Slicer 4, which says no frame",
               "Open it in 3D Slicer and save it as markups (.mrk.json).");
    if (content.starts_with("<MRML") || ends(file, ".mrml") || ends(file, ".mrb"))
        refuse("a scene of 3D Slicer", "Save the plan's markups from 3D Slicer as .mrk.json.");
    if (ends(file, ".vtm")) refuse("a list of surfaces", "Name the .vtp files one by one.");
}

PlanImport read_kind(const fs::path& file, const PlanImportSettings& settings) {
    const std::string content = read_whole(file);
    if (content.empty()) throw DamagedFileError(file, "is empty", "Export the plan again.");
    refuse_known_others(content, file);
    if (is_dicom(content) || ends(file, ".dcm"))
        return read_rtstruct(file, settings);  // old ones have no "DICM" at byte 128
    if (ends(file, ".json")) return read_markups(content, file, settings);
    if (ends(file, ".fcsv") || content.starts_with("# Markups fiducial file") ||
        content.starts_with("# Fiducial List file"))
        return read_fcsv(content, file, settings);
    if (ends(file, ".csv") || ends(file, ".tsv") || ends(file, ".txt"))
        return read_trajectory_table(content, file, settings);
    for (const char* ending : {".vtp", ".vtk", ".ply", ".obj", ".stl"})
        if (ends(file, ending)) return read_shape_plan(file, settings);
    throw InputError(
        file, "is of no kind that a plan is read from",
        "Give 3D Slicer markups (.mrk.json, .fcsv), DICOM RTSTRUCT (.dcm), a table of trajectories (.csv, .tsv), or "
        "lines (.vtp, .vtk, .ply, .obj).");
}

PlanImport read_one(const fs::path& file, const PlanImportSettings& settings) {
    PlanImport read = read_kind(file, settings);
    if (read.said_frame.space) read.said_frame.items = read.plan;
    return read;
}

bool is_plan_name(const fs::path& file) {
    for (const char* ending : {".mrk.json", ".fcsv", ".csv", ".tsv", ".dcm", ".vtp", ".vtk", ".ply", ".obj", ".stl"})
        if (ends(file, ending)) return true;
    return false;
}

/// Units that cannot be: more than one point, and all of them within 2 mm or more than a metre apart.
void check_extent(const Plan& plan, const fs::path& file) {
    const auto points = points_of(plan);
    if (points.size() < 2) return;
    Eigen::Vector3d low = points.front(), high = low;
    for (const auto& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const double across_mm = (high - low).norm();
    if (across_mm == 0)
        throw InputError(file, fmt::format("has all its {} points at one place", points.size()),
                         "Export the plan again.");
    if (!(across_mm >= kLeastAcross_mm) || across_mm > kMostAcross_mm)
        throw InputError(
            file, fmt::format("the whole plan is {:.3g} mm across: its numbers cannot be millimetres", across_mm),
            "Export the plan in mm.");
}

}  // namespace

std::string plan_name_of(const fs::path& file) {
    std::string name = file.filename().string();
    for (const char* ending : {".mrk.json", ".json"})
        if (ends(file, ending)) return on_one_line(name.substr(0, name.size() - std::string(ending).size()));
    return on_one_line(file.stem().string());
}

void append(PlanImport& to, PlanImport more) {
    if (!more.frame_of_reference_uid.empty() && !to.frame_of_reference_uid.empty() &&
        more.frame_of_reference_uid != to.frame_of_reference_uid)
        throw InputError({},
                         "The plan's files are in two frames of reference, " + to.frame_of_reference_uid + " and " +
                             more.frame_of_reference_uid,
                         "Give the plan of one CT.");
    if (to.frame_of_reference_uid.empty()) to.frame_of_reference_uid = more.frame_of_reference_uid;
    const auto move = [](auto& into, auto& from) {
        into.insert(into.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
    };
    move(to.plan.trajectories, more.plan.trajectories);
    move(to.plan.boreholes, more.plan.boreholes);
    move(to.plan.osteotomy_lines, more.plan.osteotomy_lines);
    move(to.plan.cut_planes, more.plan.cut_planes);
    move(to.plan.risk_structures, more.plan.risk_structures);
    move(to.notes, more.notes);
    to.says_other_space |= more.says_other_space;
    if (more.said_frame.space) to.said_frame.space = more.said_frame.space;
    move(to.said_frame.items.trajectories, more.said_frame.items.trajectories);
    move(to.said_frame.items.boreholes, more.said_frame.items.boreholes);
    move(to.said_frame.items.osteotomy_lines, more.said_frame.items.osteotomy_lines);
    move(to.said_frame.items.cut_planes, more.said_frame.items.cut_planes);
}

namespace {

/// Names stand in rows, on the skin and in tables.
void put_names_on_one_line(Plan& plan) {
    for (auto& item : plan.trajectories) item.name = on_one_line(item.name);
    for (auto& item : plan.boreholes) item.name = on_one_line(item.name);
    for (auto& item : plan.osteotomy_lines) item.name = on_one_line(item.name);
    for (auto& item : plan.cut_planes) item.name = on_one_line(item.name);
    for (auto& item : plan.risk_structures) item.name = on_one_line(item.name);
}

PlanImport looked_over(PlanImport read, const fs::path& file_or_folder) {
    put_names_on_one_line(read.plan);
    check_plan_limits(read.plan, file_or_folder);
    check_extent(read.plan, file_or_folder);
    return read;
}

/// What else lies in a folder of a plan: a part of it may be among that. Empty where there is nothing.
std::string left_out_of(const fs::path& folder) {
    constexpr std::size_t kNamed = 4;
    std::vector<std::string> left_out;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with('.') || is_plan_name(entry.path())) continue;
        std::error_code ignored;
        left_out.push_back(on_one_line(name) + (entry.is_directory(ignored) ? "/" : ""));
    }
    if (left_out.empty()) return {};
    std::sort(left_out.begin(), left_out.end());
    const std::size_t named = std::min(left_out.size(), kNamed);
    const std::vector<std::string> first(left_out.begin(), left_out.begin() + static_cast<std::ptrdiff_t>(named));
    return fmt::format(
        "Not read from {}: {}{}. Give a file of the plan that is among these by itself, or save it as .mrk.json.",
        on_one_line(folder.string()), fmt::join(first, ", "),
        left_out.size() > named ? fmt::format(" and {} more", left_out.size() - named) : "");
}

}  // namespace

Space space_of_plan(const SpaceSaid& file_says, const PlanImportSettings& settings, const fs::path& file,
                    std::string_view how_to_say, PlanImport& read) {
    if (settings.one_of_several && file_says.space && settings.space && *file_says.space != *settings.space) {
        std::string note =
            fmt::format("{} says that it is in {}, and is read so: --frame {} is for files that do not say",
                        file.filename().string(), name_of(*file_says.space), name_of(*settings.space));
        if (std::ranges::find(read.notes, note) == read.notes.end()) read.notes.push_back(std::move(note));
        read.says_other_space = true;
        return *file_says.space;
    }
    const Space space = settled_space(file_says, settings.space, file, how_to_say);
    if (!file_says.space) read.said_frame.space = space;
    return space;
}

namespace {

std::vector<fs::path> plan_files_in(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder))
        if (is_plan_name(entry.path()) && !entry.path().filename().string().starts_with('.'))  // a Mac's `._plan`
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    if (files.empty())
        throw InputError(folder, "holds no plan file",
                         "Save the plan's markups from 3D Slicer (.mrk.json) into this folder.");
    return files;
}

PlanImport import_path(const fs::path& file_or_folder, const PlanImportSettings& settings) {
    if (!fs::is_directory(file_or_folder)) return looked_over(read_one(file_or_folder, settings), file_or_folder);
    PlanImport all;
    for (const auto& file : plan_files_in(file_or_folder)) append(all, read_one(file, settings));
    if (std::string left_out = left_out_of(file_or_folder); !left_out.empty()) all.notes.push_back(std::move(left_out));
    return looked_over(std::move(all), file_or_folder);
}

}  // namespace

PlanImport import_plan(const std::vector<fs::path>& files, PlanImportSettings settings) {
    std::size_t count = 0;
    for (const auto& file : files) {
        check_exists(file, "Check the name of the file or folder.");
        count += fs::is_directory(file) ? plan_files_in(file).size() : 1;
    }
    settings.one_of_several = count > 1;
    PlanImport all;
    for (const auto& file : files) append(all, import_path(file, settings));
    if (all.says_other_space && !all.said_frame.space)
        throw InputError(files.front(),
                         fmt::format("and all other files of the plan say their coordinate system, --frame {} says "
                                     "another",
                                     name_of(*settings.space)),
                         "Leave --frame out, or export the plan again.");
    return all;
}

PlanImport import_plan(const fs::path& file_or_folder, const PlanImportSettings& settings) {
    return import_plan(std::vector{file_or_folder}, settings);
}

}  // namespace planlight
