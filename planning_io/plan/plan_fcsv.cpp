#include "planning_io/plan/plan_fcsv.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "planning_io/files/header_text.h"
#include "planning_io/plan/header_statements.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_settings.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr const char* kSaveAgain = "Save the points from 3D Slicer as .mrk.json.";
constexpr const char* kSayIt = "Save the points from 3D Slicer as .mrk.json";
constexpr double kMaxCoordinate_mm = 5000;

std::string trimmed(std::string_view text) {
    const auto begin = text.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return {};
    return std::string(text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1));
}

/// The lines "# key = value" at the head of the file.
struct Header {
    bool slicer3 = false;
    std::string comments;
    std::map<std::string, std::string> values;
    std::map<std::string, std::size_t> column;
};

constexpr const char* kCoordinateSystem = "CoordinateSystem";

std::optional<Space> space_of(const Header& header, const fs::path& file) {
    const auto given = header.values.find(kCoordinateSystem);
    if (given != header.values.end()) {
        const std::string word = lower_case(given->second);
        if (word == "0" || word == "ras") return Space::ras;
        if (word == "1" || word == "lps") return Space::lps;
        if (word == "2" || word == "ijk")
            throw InputError(file, "is in voxels (CoordinateSystem = " + given->second + "), not in mm", kSaveAgain);
        throw InputError(file, "says CoordinateSystem = \"" + given->second + "\", which is none", kSaveAgain);
    }
    return header.slicer3 ? std::optional(Space::ras) : std::nullopt;
}

/// Also from comments in other words.
SpaceSaid space_said_by(const Header& header, const fs::path& file) {
    const std::optional<Space> space = space_of(header, file);
    SpaceSaid said = space_said(header.comments, file);
    if (space && said.space && *space != *said.space)
        throw InputError(file, "says both that it is in LPS and that it is in RAS", kSaveAgain);
    if (space) said.space = space;
    return said;
}

void read_header_line(Header& header, const std::string& line, const fs::path& file) {
    if (line.starts_with("# Fiducial List file")) header.slicer3 = true;
    header.comments += line + '\n';
    const auto equals = line.find_first_of("=:");
    if (equals == std::string::npos) return;
    std::string key = trimmed(line.substr(1, equals - 1));
    const std::string value = trimmed(line.substr(equals + 1));
    if (std::string letters = lower_case(key);
        std::erase_if(letters, [](char c) { return c == ' ' || c == '_'; }), letters == "coordinatesystem")
        key = kCoordinateSystem;
    else if (line[equals] == ':')
        return;
    const auto [at, fresh] = header.values.emplace(key, value);
    if (!fresh && at->second != value) throw InputError(file, "says \"" + key + "\" twice, differently", kSaveAgain);
    if (key != "columns") return;
    const auto names = split_fields(value, ',');
    for (std::size_t i = 0; i < names.size(); ++i) header.column.emplace(names[i], i);
}

class Row {
public:
    Row(const Header& header, std::vector<std::string> fields, int line, const fs::path& file)
        : header_(header), fields_(std::move(fields)), line_(line), file_(file) {}
    [[noreturn]] void refuse(const std::string& problem) const {
        throw InputError(file_, fmt::format("line {} {}", line_, problem), "Correct the point in 3D Slicer.");
    }
    std::string text(const char* column) const {
        const auto at = header_.column.find(column);
        if (at == header_.column.end()) return {};
        if (at->second >= fields_.size())
            refuse(fmt::format("has {} fields; \"{}\" is missing", fields_.size(), column));
        return trimmed(fields_[at->second]);
    }
    double number(const char* column) const {
        const auto value = number_in(text(column));
        if (!value || std::abs(*value) > kMaxCoordinate_mm)
            refuse(fmt::format("has {} = \"{}\", not a number of mm within 5 m", column, text(column)));
        return *value;
    }
    /// From version 5 on the fields go on after the named ones with the position's status (2 = placed).
    void check_placed() const {
        const auto last = header_.column.find("associatedNodeID");
        if (last == header_.column.end() || fields_.size() <= last->second + 1) return;
        const std::string status = trimmed(fields_[last->second + 1]);
        if (!status.empty() && status != "2") refuse("is a point that is not placed (status " + status + ")");
    }

private:
    const Header& header_;
    std::vector<std::string> fields_;
    int line_;
    const fs::path& file_;
};

Borehole borehole_of(const Row& row, Space space, const std::string& otherwise) {
    row.check_placed();
    const PlanSettings said(row.text("desc"), [&](const std::string& problem) { row.refuse(problem); });
    Borehole b;
    b.name = row.text("label");
    if (b.name.empty()) b.name = otherwise;
    b.position_in_ct = to_ct({row.number("x"), row.number("y"), row.number("z")}, space);
    b.diameter_mm = said.length_mm("diameter_mm", kMaxDiameter_mm);
    b.depth_mm = said.length_mm("depth_mm", kMaxDepth_mm);
    return b;
}

}  // namespace

std::vector<std::string> split_fields(std::string_view line, char separator) {
    if (line.ends_with('\r')) line.remove_suffix(1);
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
            fields.back() += line[++i];
        else if (c == '"')
            quoted = !quoted;
        else if (c == separator && !quoted)
            fields.emplace_back();
        else
            fields.back() += c;
    }
    return fields;
}

std::optional<double> number_in(std::string_view field) {
    double value = 0;
    const auto [stop, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || stop != field.data() + field.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

PlanImport read_fcsv(const std::string& content, const fs::path& file, const PlanImportSettings& settings) {
    PlanImport read;
    Header header;
    std::optional<Space> space;
    std::istringstream lines(without_byte_order_mark(content));
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (line.starts_with("#")) {
            read_header_line(header, line, file);
            continue;
        }
        if (trimmed(line).empty()) continue;
        if (!space) {
            for (const char* column : {"x", "y", "z"})
                if (!header.column.contains(column))
                    throw InputError(file, fmt::format("names no column \"{}\" in a line \"# columns = ...\"", column),
                                     kSaveAgain);
            space = space_of_plan(space_said_by(header, file), settings, file, kSayIt, read);
            if (header.slicer3)
                read.notes.push_back(file.filename().string() + " is a list of Slicer 3, which is always RAS");
        }
        const Row row(header, split_fields(line, ','), number, file);
        read.plan.boreholes.push_back(
            borehole_of(row, *space, fmt::format("{}-{}", plan_name_of(file), read.plan.boreholes.size() + 1)));
    }
    if (space && space_of_plan(space_said_by(header, file), settings, file, kSayIt, read) != *space)
        throw InputError(file, "says another coordinate system below its first point", kSaveAgain);
    if (unit_said(header.comments, file, "write the line \"# units=mm\" before the points").value_or(1) != 1)
        throw InputError(file, "is in um, not in mm", kSaveAgain);
    if (const auto count = header.values.find("numPoints");
        count != header.values.end() && number_in(count->second) != static_cast<double>(read.plan.boreholes.size()))
        read.notes.push_back(fmt::format("{} announces {} points and holds {}", file.filename().string(), count->second,
                                         read.plan.boreholes.size()));
    if (read.plan.empty()) throw InputError(file, "holds no points", kSaveAgain);
    return read;
}

}  // namespace planlight
