#pragma once

#include <filesystem>
#include <string>

namespace planlight {

/// Throws InputError where there is nothing of that name (with `remedy`), where a link leads nowhere, and where nobody
/// can tell: a folder on the way may not be entered, or the name is too long.
void check_exists(const std::filesystem::path& path, const std::string& remedy = "Check the name of the file.");

}  // namespace planlight
