#pragma once

#include <filesystem>
#include <string>

namespace planlight::test {

/// The guide's page of all refusals (app/guide/refusals.md), from the sources under `root`.
std::string refusals_page(const std::filesystem::path& root);

}  // namespace planlight::test
