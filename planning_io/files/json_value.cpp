#include "planning_io/files/json_value.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "planning_io/files/nearest_word.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
constexpr int kMaxDepth = 32;
constexpr const char* kCorrect =
    "Correct the file; its format stands in planning_io/FORMATS.md (below /usr/share/doc/planlight when installed).";

template <std::size_t N>
std::array<double, N> numbers(const JsonValue& value) {
    if (value.size() != N) value.refuse("must be " + std::to_string(N) + " numbers");
    std::array<double, N> result{};
    for (std::size_t i = 0; i < N; ++i) result[i] = value[i].number();
    return result;
}

}  // namespace

Json parse_json(std::string_view text, const fs::path& file) {
    if (text.size() > kMaxBytes)
        throw InputError(file, "is larger than 64 MiB", "Give the file that Planlight or 3D Slicer wrote.");
    std::vector<std::set<std::string>> names;
    const auto guard = [&](int depth, Json::parse_event_t event, Json& parsed) {
        if (depth > kMaxDepth) throw InputError(file, "is nested deeper than 32 levels", kCorrect);
        if (event == Json::parse_event_t::object_start) names.emplace_back();
        if (event == Json::parse_event_t::object_end) names.pop_back();
        if (event == Json::parse_event_t::key && !names.back().insert(parsed.get<std::string>()).second)
            throw InputError(file, "says \"" + parsed.get<std::string>() + "\" twice", kCorrect);
        return true;
    };
    try {
        return Json::parse(text, guard);
    } catch (const Json::exception& e) {
        const std::string said = e.what(), before = "parse error at ";  // after the library's own number of the error
        const auto at = said.find(before);
        throw DamagedFileError(
            file, "is not whole JSON (" + (at == std::string::npos ? said : said.substr(at + before.size())) + ")",
            "Write or copy the file again.");
    }
}

void JsonValue::refuse(const std::string& problem, const std::string& what_to_do) const {
    throw InputError(*file_, (place_.empty() ? std::string("the file") : place_) + " " + problem,
                     what_to_do.empty() ? kCorrect : what_to_do);
}

std::optional<JsonValue> JsonValue::find(const char* key) const {
    if (!value_->is_object()) refuse("must be an object");
    const auto found = value_->find(key);
    if (found == value_->end() || found->is_null()) return std::nullopt;
    return JsonValue(*found, *file_, place_.empty() ? key : place_ + "." + key);
}

void JsonValue::has_only(std::initializer_list<const char*> known) const {
    if (!value_->is_object()) refuse("must be an object");
    for (const auto& entry : value_->items()) {
        const std::string& name = entry.key();
        const auto is_name = [&](const char* other) { return name == other; };
        if (is_name("notes") || name.starts_with("x_") || std::any_of(known.begin(), known.end(), is_name)) continue;
        const auto nearest = nearest_word(name, {known.begin(), known.end()});
        refuse("has a name that means nothing here, \"" + name + "\"" +
                   (nearest ? "; is \"" + *nearest + "\" meant?" : std::string()),
               "Correct the name (planning_io/FORMATS.md, below /usr/share/doc/planlight when installed, lists them); "
               "notes of your own may stand under \"notes\" or "
               "under names "
               "that begin with x_.");
    }
}

JsonValue JsonValue::at(const char* key) const {
    const auto found = find(key);
    if (!found) refuse(std::string("has no \"") + key + "\"");
    return *found;
}

std::size_t JsonValue::size() const {
    if (!value_->is_array()) refuse("must be a list");
    return value_->size();
}

JsonValue JsonValue::operator[](std::size_t i) const {
    return {(*value_)[i], *file_, place_ + "[" + std::to_string(i) + "]"};
}

double JsonValue::number() const {
    if (!value_->is_number()) refuse("must be a number");
    const double result = value_->get<double>();
    if (!std::isfinite(result)) refuse("must be a finite number");
    return result;
}

double JsonValue::number(double least, double most) const {
    const double result = number();
    if (result < least || result > most)
        refuse("is " + Json(result).dump() + ", not between " + Json(least).dump() + " and " + Json(most).dump());
    return result;
}

std::int64_t JsonValue::integer(std::int64_t least, std::int64_t most) const {
    if (!value_->is_number_integer()) refuse("must be a whole number");
    const bool too_large =
        value_->is_number_unsigned() && value_->get<std::uint64_t>() > static_cast<std::uint64_t>(INT64_MAX);
    const auto result = value_->get<std::int64_t>();
    if (too_large || result < least || result > most)
        refuse("is " + value_->dump() + ", not between " + std::to_string(least) + " and " + std::to_string(most));
    return result;
}

std::string JsonValue::text() const {
    if (!value_->is_string()) refuse("must be a text");
    return value_->get<std::string>();
}

bool JsonValue::flag() const {
    if (!value_->is_boolean()) refuse("must be true or false");
    return value_->get<bool>();
}

Eigen::Vector3d JsonValue::vector3() const {
    return Eigen::Map<const Eigen::Vector3d>(numbers<3>(*this).data());
}

Eigen::Matrix3d JsonValue::matrix3() const {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers<9>(*this).data());
}

RigidTransform JsonValue::transform() const {
    const auto values = numbers<16>(*this);
    const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
    if (!is_rigid(matrix))
        refuse("is not a rotation and a translation (rows orthonormal to 1e-6, determinant +1, last row 0 0 0 1)");
    return RigidTransform(matrix);
}

void check_format(const JsonValue& root, const char* format, int version, const fs::path& file) {
    const auto given = root.find("format");
    if (!given || !given->is_text() || given->text() != format)
        root.refuse(std::string("does not say \"format\": \"") + format + "\"");
    const auto number = root.at("version").integer(0, 1000000);
    if (number != version)
        throw DamagedFileError(
            file, "is of version " + std::to_string(number) + "; this program reads version " + std::to_string(version),
            "Write it again with this version of Planlight.");
}

Json to_json(const Eigen::Vector3d& v) {
    return Json::array({v.x(), v.y(), v.z()});
}

Json to_json(const Eigen::Matrix3d& m) {
    Json list = Json::array();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) list.push_back(m(row, column));
    return list;
}

Json to_json(const RigidTransform& t) {
    Json list = Json::array();
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) list.push_back(t.matrix()(row, column));
    return list;
}

std::string dump(const Json& value) {
    return value.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace planlight
