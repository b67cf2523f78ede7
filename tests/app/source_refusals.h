#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace planlight::test {

/// A place in the product's sources where something is refused: what is said and what is advised, with "…" for what is
/// only known at run time.
struct SourceRefusal {
    std::string file;  ///< from the root, "planning_io/plan/plan_table.cpp"
    int line = 0;
    std::string kind;  ///< "InputError", "DamagedFileError", ...
    std::string problem, remedy;
};

/// Every `Error(...)` of the rooms and the app, in the order of the files' names. Text that comes from another function
/// is not followed: it is "…".
std::vector<SourceRefusal> refusals_in_sources(const std::filesystem::path& root);

/// The options ("--frame") that a text names.
std::vector<std::string> options_named(const std::string& text);

}  // namespace planlight::test
