#include "planning_io/plan/plan_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "planning_io/files/header_text.h"
#include "planning_io/plan/plan_fcsv.h"
#include "planning_io/plan/plan_settings.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr double kMaxCoordinate_mm = 5000;
constexpr const char* kHowTo = "Name the columns name, ex, ey, ez (entry), tx, ty, tz (target)";

struct Columns {
    std::size_t name = 0;
    std::array<std::size_t, 3> entry{}, target{};
    std::optional<std::size_t> diameter;
    std::size_t count = 0;
};

std::optional<std::array<std::size_t, 3>> triple(const std::map<std::string, std::size_t>& at,
                                                 const std::array<const char*, 3>& names) {
    std::array<std::size_t, 3> found{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto column = at.find(names[i]);
        if (column == at.end()) return std::nullopt;
        found[i] = column->second;
    }
    return found;
}

Columns columns_of(const std::vector<std::string>& names, const fs::path& file, std::vector<std::string>& notes) {
    std::map<std::string, std::size_t> at;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (!at.emplace(names[i], i).second)
            throw InputError(file, "names the column \"" + names[i] + "\" twice", std::string(kHowTo) + ".");
    auto entry = triple(at, {"ex", "ey", "ez"}), target = triple(at, {"tx", "ty", "tz"});
    if (!entry) entry = triple(at, {"entry_x", "entry_y", "entry_z"});
    if (!target) target = triple(at, {"target_x", "target_y", "target_z"});
    if (!entry || !target)
        throw InputError(
            file,
            fmt::format("does not name an entry and a target of each trajectory; its columns are {}",
                        fmt::join(names, ", ")),
            std::string(kHowTo) + "; lists of contacts, and of a start and an end, do not say which is which.");
    if (!at.contains("name")) throw InputError(file, "names no column \"name\"", std::string(kHowTo) + ".");
    Columns columns{at["name"], *entry, *target, std::nullopt, names.size()};
    if (at.contains("diameter_mm")) columns.diameter = at["diameter_mm"];
    std::vector<std::string> left_out;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const bool used = i == columns.name || i == columns.diameter || std::count(entry->begin(), entry->end(), i) ||
                          std::count(target->begin(), target->end(), i);
        if (!used) left_out.push_back(names[i]);
    }
    if (!left_out.empty())
        notes.push_back(
            fmt::format("{}: the columns {} are left out", file.filename().string(), fmt::join(left_out, ", ")));
    return columns;
}

/// mm per unit that the comment lines say; 1 when they say none.
double unit_in(const std::string& comments, const fs::path& file) {
    const auto at = comments.find("units=");
    if (at == std::string::npos) return 1;
    std::string unit;
    std::istringstream(comments.substr(at + 6)) >> unit;
    if (unit == "mm") return 1;
    if (unit == "um") return 1e-3;
    throw InputError(file, "says units=" + unit + ", neither mm nor um", "Export the table in mm.");
}

class Row {
public:
    Row(std::vector<std::string> fields, int line, const fs::path& file)
        : fields_(std::move(fields)), line_(line), file_(file) {}
    [[noreturn]] void refuse(const std::string& problem) const {
        throw InputError(file_, fmt::format("line {} {}", line_, problem), "Correct this line.");
    }
    const std::string& text(std::size_t column) const { return fields_[column]; }
    double number(std::size_t column, double most) const {
        const auto value = number_in(fields_[column]);
        if (!value || std::abs(*value) > most)
            refuse(fmt::format("has \"{}\" where a number within {} must stand", fields_[column], most));
        return *value;
    }
    Vector3d point(const std::array<std::size_t, 3>& columns, double mm_per_unit) const {
        Vector3d p;
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = mm_per_unit * number(columns[static_cast<std::size_t>(axis)], kMaxCoordinate_mm / mm_per_unit);
        return p;
    }
    void check_count(std::size_t count) const {
        if (fields_.size() != count) refuse(fmt::format("has {} fields, the header has {}", fields_.size(), count));
    }

private:
    std::vector<std::string> fields_;
    int line_;
    const fs::path& file_;
};

Trajectory trajectory_of(const Row& row, const Columns& columns, Space space, double mm_per_unit) {
    row.check_count(columns.count);
    Trajectory t;
    t.name = row.text(columns.name);
    t.entry_in_ct = to_ct(row.point(columns.entry, mm_per_unit), space);
    t.target_in_ct = to_ct(row.point(columns.target, mm_per_unit), space);
    if (columns.diameter && !row.text(*columns.diameter).empty())
        t.diameter_mm = row.number(*columns.diameter, kMaxDiameter_mm);
    if (t.diameter_mm < 0) row.refuse("has a negative diameter");
    if (!(t.length_mm() > 1e-3)) row.refuse("(\"" + t.name + "\") is a trajectory of no length");
    return t;
}

char separator_in(const std::string& header) {
    for (const char c : {'\t', ';'})
        if (header.find(c) != std::string::npos) return c;
    return ',';
}

}  // namespace

PlanImport read_trajectory_table(const std::string& content, const fs::path& file, const PlanImportSettings& settings) {
    PlanImport read;
    std::string comments;
    std::optional<Columns> columns;
    char separator = ',';
    Space space = Space::lps;
    double mm_per_unit = 1;
    std::istringstream lines(without_byte_order_mark(content));
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        if (line.starts_with("#")) {
            constexpr std::string_view kNames = "# columns:";  // some programs name the columns in a comment
            if (!columns && line.starts_with(kNames))
                line = line.substr(line.find_first_not_of(' ', kNames.size()));
            else {
                comments += line + '\n';
                continue;
            }
        }
        if (!columns) {
            separator = separator_in(line);
            columns = columns_of(split_fields(line, separator), file, read.notes);
            continue;
        }
        if (read.plan.empty()) {
            space = settled_space(space_marked(comments, file), settings.space, file,
                                  "Put the line \"# SPACE=LPS\" (or RAS) before the table");
            mm_per_unit = unit_in(comments, file);
        }
        read.plan.trajectories.push_back(
            trajectory_of(Row(split_fields(line, separator), number, file), *columns, space, mm_per_unit));
    }
    if (const auto said = space_marked(comments, file);
        !read.plan.empty() && ((said && *said != space) || unit_in(comments, file) != mm_per_unit))
        throw InputError(file, "says another coordinate system or unit below its first row",
                         "Put the lines that say them before the table.");
    if (read.plan.empty()) throw InputError(file, "holds no trajectories", std::string(kHowTo) + ".");
    return read;
}

}  // namespace planlight
