#include "planning_io/plan/plan_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "planning_io/files/header_text.h"
#include "planning_io/plan/header_statements.h"
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
    std::vector<std::pair<std::size_t, std::string>> statements = {};  ///< columns that say a frame or a unit
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
        if (used) continue;
        if (names_the_space(names[i]) || names_the_unit(names[i]))
            columns.statements.emplace_back(i, names[i]);
        else
            left_out.push_back(names[i]);
    }
    if (!left_out.empty())
        notes.push_back(
            fmt::format("{}: the columns {} are left out", file.filename().string(), fmt::join(left_out, ", ")));
    return columns;
}

constexpr const char* kSayUnit = "write the line \"# units=mm\" before the table";

/// mm per unit that the comment lines and the row's columns say; 1 when they say none.
double unit_in(const std::string& words, const fs::path& file) {
    if (const auto said = unit_said(words, file, kSayUnit)) return *said;
    const auto at = words.find("units=");
    if (at == std::string::npos) return 1;
    std::string unit;
    std::istringstream(words.substr(at + 6)) >> unit;
    throw InputError(file, "says units=" + unit + ", neither mm nor um", "Export it again in mm.");
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

/// "frame: RAS", a line for each column that may say so.
std::string statements_of(const std::vector<std::string>& fields, const Columns& columns) {
    std::string said;
    for (const auto& [column, name] : columns.statements)
        if (column < fields.size()) said += name + ": " + fields[column] + '\n';
    return said;
}

void note_unsaid(const std::vector<std::string>& fields, const Columns& columns, const fs::path& file,
                 std::vector<std::string>& notes) {
    for (const auto& [column, name] : columns.statements) {
        if (column >= fields.size()) continue;
        const std::string said = name + ": " + fields[column];
        if (!space_said(said, file).space && !unit_said(said, file, kSayUnit))
            notes.push_back(fmt::format("{}: the column {} is left out: it says neither LPS or RAS nor a unit",
                                        file.filename().string(), name));
    }
}

/// In which frame and unit the table's numbers are: said once, and never otherwise.
class Numbers {
public:
    Numbers(const fs::path& file, const PlanImportSettings& settings, PlanImport& read)
        : file_(file), settings_(settings), read_(read) {}
    Space space() const { return space_; }
    double mm_per_unit() const { return mm_per_unit_; }

    void hear(const std::string& words) {
        if (heard_ && words == words_) return;
        const Space space = space_of_plan(space_said(words, file_), settings_, file_,
                                          "Put the line \"# SPACE=LPS\" (or RAS) before the table", read_);
        const double mm_per_unit = unit_in(words, file_);
        if (heard_ && (space != space_ || mm_per_unit != mm_per_unit_))
            throw InputError(file_, "says another coordinate system or unit below its first row",
                             "Put the lines that say them before the table.");
        heard_ = true;
        words_ = words;
        space_ = space;
        mm_per_unit_ = mm_per_unit;
    }

private:
    const fs::path& file_;
    const PlanImportSettings& settings_;
    PlanImport& read_;
    bool heard_ = false;
    std::string words_;
    Space space_ = Space::lps;
    double mm_per_unit_ = 1;
};

char separator_in(const std::string& header) {
    for (const char c : {'\t', ';'})
        if (header.find(c) != std::string::npos) return c;
    return ',';
}

}  // namespace

PlanImport read_trajectory_table(const std::string& content, const fs::path& file, const PlanImportSettings& settings) {
    PlanImport read;
    std::string comments, of_the_row;
    std::optional<Columns> columns;
    char separator = ',';
    Numbers numbers(file, settings, read);
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
        const auto fields = split_fields(line, separator);
        of_the_row = statements_of(fields, *columns);
        if (read.plan.empty()) note_unsaid(fields, *columns, file, read.notes);
        numbers.hear(comments + of_the_row);
        read.plan.trajectories.push_back(
            trajectory_of(Row(fields, number, file), *columns, numbers.space(), numbers.mm_per_unit()));
    }
    if (!read.plan.empty()) numbers.hear(comments + of_the_row);
    if (read.plan.empty()) throw InputError(file, "holds no trajectories", std::string(kHowTo) + ".");
    return read;
}

}  // namespace planlight
