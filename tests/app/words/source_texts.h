#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace planlight::test {

/// The string literals of a C++ source, those that stand side by side as one; without includes and comments. Escapes
/// are resolved, placeholders of fmt stay.
std::vector<std::string> literals_in(const std::filesystem::path& source);

/// The text as it may be when it is said: each field ("{}", "{:.1f}", "…") is a number, or nothing.
std::vector<std::string> as_said(const std::string& text);

/// It is written for a person: several words, of which one is longer than two letters.
bool is_sentence(const std::string& text);

}  // namespace planlight::test
