#pragma once

#include <filesystem>
#include <string>

namespace planlight::test {

/// What a run of the program gave.
struct CommandRun {
    int exit_code = -1;  ///< 128 + signal when it was killed
    std::string out, err;
};

/// Runs `planlight ARGUMENTS` (shell words) in `folder`.
CommandRun run_planlight(const std::string& arguments, const std::filesystem::path& folder);

}  // namespace planlight::test
