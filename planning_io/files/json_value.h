#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "planning_io/types/rigid_transform.h"

// Heavy: for .cpp files of this room only.

namespace planlight {

using Json = nlohmann::ordered_json;

/// Parses with limits (64 MiB, 32 levels, no name twice in an object). Throws DamagedFileError where it is not JSON.
Json parse_json(std::string_view text, const std::filesystem::path& file);

/// A place in a JSON file that knows its name: what is missing or of the wrong kind is an InputError with file and
/// place.
class JsonValue {
public:
    JsonValue(const Json& value, const std::filesystem::path& file, std::string place = {})
        : value_(&value), file_(&file), place_(std::move(place)) {}

    JsonValue at(const char* key) const;
    std::optional<JsonValue> find(const char* key) const;  ///< empty when missing or null
    /// Refuses an object that has a name besides these, "notes" and those that begin with "x_" (a person's own): a
    /// misspelt name that may be missing would be passed over in silence.
    void has_only(std::initializer_list<const char*> known) const;
    std::size_t size() const;  ///< of an array
    JsonValue operator[](std::size_t i) const;

    double number() const;  ///< finite
    double number(double least, double most) const;
    std::int64_t integer(std::int64_t least, std::int64_t most) const;
    std::string text() const;
    bool flag() const;
    bool is_text() const { return value_->is_string(); }
    Eigen::Vector3d vector3() const;
    Eigen::Matrix3d matrix3() const;   ///< nine numbers, row by row
    RigidTransform transform() const;  ///< sixteen numbers, row by row; refused unless rigid to 1e-6

    /// Refuses the value: "FILE: PLACE problem".
    [[noreturn]] void refuse(const std::string& problem, const std::string& what_to_do = {}) const;

private:
    const Json* value_;
    const std::filesystem::path* file_;
    std::string place_;
};

/// Refuses a file whose "format" is another, or whose "version" is not `version` (that with DamagedFileError).
void check_format(const JsonValue& root, const char* format, int version, const std::filesystem::path& file);

/// [x, y, z].
Json to_json(const Eigen::Vector3d& v);
Json to_json(const Eigen::Matrix3d& m);  ///< row by row
Json to_json(const RigidTransform& t);   ///< 4x4, row by row
std::string dump(const Json& value);     ///< indented, numbers so that they read back bit for bit

}  // namespace planlight
