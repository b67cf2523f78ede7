#include "planning_io/plan/point_pairs_file.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include "planning_io/files/header_text.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/coordinate_space.h"
#include "planning_io/plan/header_statements.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr const char* kColumns = "name,ct_x,ct_y,ct_z,rig_x,rig_y,rig_z";
constexpr double kMaxCoordinate_mm = 5000;

std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream in(line);
    for (std::string field; std::getline(in, field, ',');) {
        const auto first = field.find_first_not_of(" \t"), last = field.find_last_not_of(" \t");
        fields.push_back(first == std::string::npos ? "" : field.substr(first, last - first + 1));
    }
    return fields;
}

double number(const std::string& text, int line, const std::filesystem::path& file) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(std::abs(value) <= kMaxCoordinate_mm))
        throw InputError(file, fmt::format("has \"{}\" in line {}, which is no coordinate in mm", text, line),
                         "Write plain numbers, mm.");
    return value;
}

}  // namespace

std::vector<PointPair> read_point_pairs(const std::filesystem::path& file) {
    std::istringstream in(without_byte_order_mark(read_whole(file)));
    std::string comments;
    std::vector<PointPair> pairs;
    std::set<std::string> names;
    bool has_columns = false;
    int number_of_line = 0;
    for (std::string line; std::getline(in, line);) {
        ++number_of_line;
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line.empty()) continue;
        if (line.front() == '#') {
            comments += line + '\n';
            continue;
        }
        if (!has_columns) {
            if (line != kColumns)
                throw InputError(file, "does not begin with its columns",
                                 fmt::format("Write \"{}\" before the landmarks.", kColumns));
            has_columns = true;
            continue;
        }
        const auto fields = fields_of(line);
        if (fields.size() != 7 || fields[0].empty())
            throw InputError(file,
                             fmt::format("has {} fields in line {}; a landmark has a name and six numbers",
                                         fields.size(), number_of_line),
                             fmt::format("Write each landmark as {}.", kColumns));
        if (!names.insert(fields[0]).second)
            throw InputError(file, fmt::format("names the landmark \"{}\" twice", fields[0]),
                             "Give each landmark a name of its own.");
        std::array<double, 6> v{};
        for (std::size_t i = 0; i < 6; ++i) v[i] = number(fields[i + 1], number_of_line, file);
        pairs.push_back({fields[0], {v[0], v[1], v[2]}, {v[3], v[4], v[5]}});
    }
    const Space of_ct = settled_space(space_said(comments, file), std::nullopt, file,
                                      "Write the line \"# SPACE=LPS\" or \"# SPACE=RAS\" at its beginning", "");
    for (PointPair& pair : pairs) pair.in_ct = to_ct(pair.in_ct, of_ct);
    return pairs;
}

void write_point_pairs(const std::vector<PointPair>& pairs, const std::filesystem::path& file) {
    std::string table = fmt::format("# SPACE=LPS\n{}\n", kColumns);
    for (const PointPair& pair : pairs) {
        if (pair.name.empty() || pair.name.find_first_of(",\n\r") != std::string::npos || pair.name.front() == '#')
            throw InputError(file, "cannot hold the landmark name \"" + pair.name + "\"",
                             "Name it without commas and '#'.");
        table += fmt::format("{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f}\n", pair.name, pair.in_ct.x(),
                             pair.in_ct.y(), pair.in_ct.z(), pair.in_rig.x(), pair.in_rig.y(), pair.in_rig.z());
    }
    write_safely(file, table);
}

}  // namespace planlight
