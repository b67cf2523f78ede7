#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>
#include <string>

#include "planning_io/files/json_value.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "planning_io/types/time.h"

// What the JSON files of recordings share. Private to planning_io/case.
namespace planlight::recording {

inline constexpr int kVersion = 1;
inline constexpr std::int64_t kAny = std::numeric_limits<std::int64_t>::max();

/// A name that is a file name and nothing more.
inline void check_name(const std::string& name, const std::filesystem::path& file) {
    const bool plain =
        !name.empty() && name.size() <= 100 &&
        std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; });
    if (!plain)
        throw InputError(file, "names a pattern \"" + name + "\"",
                         "Use letters, digits, _ and - in names of patterns only.");
}

/// The parsed file, when it is of this format and of a version that can be read.
inline Json parse_file(const std::filesystem::path& file, const char* format) {
    Json json = parse_json(read_whole(file), file);
    check_format(JsonValue(json, file), format, kVersion, file);
    return json;
}

inline Instant instant_of(const JsonValue& value) {
    return Instant(value.integer(-kAny, kAny));
}

}  // namespace planlight::recording
