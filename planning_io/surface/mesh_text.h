#pragma once

#include <Eigen/Core>
#include <charconv>
#include <filesystem>
#include <sstream>
#include <string>

#include "planning_io/types/error.h"

// Numbers in mesh files that are text (STL, OBJ). Private to planning_io/surface.
namespace planlight {

[[noreturn]] inline void refuse_damaged(const std::filesystem::path& file, const std::string& problem) {
    throw DamagedFileError(file, problem, "Export or copy the file again.");
}

/// The number that a word of a text file is; DamagedFileError where it is none.
inline double parse_number(std::string_view word, const std::filesystem::path& file) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || stop != word.data() + word.size())
        refuse_damaged(file, "has \"" + std::string(word.substr(0, 20)) + "\" where a number must stand");
    return value;
}

/// The next three words as a point.
inline Eigen::Vector3d parse_point(std::istringstream& words, const std::filesystem::path& file) {
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis) {
        std::string word;
        words >> word;
        p[axis] = parse_number(word, file);
    }
    return p;
}

}  // namespace planlight
